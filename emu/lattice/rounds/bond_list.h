// SPDX-License-Identifier: MIT
// Of a bonded program: a block's bonds as entries (block.h), each from its particle's end, for as long as
// particles are stored as they are. What rounds keep of a bond stands at the slot of its entry's lane, so a
// vector reads it as it reads positions.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/rounds/pair_parts.h"
#include "emu/lattice/snapshot.h"
#include "model/graph/bond_rows.h"

namespace cuboct::emu {

// The cells across which bonds meet.
struct BondSpace {
  const graph::BondRows* rows = nullptr;  // null: the program has no bonds
  double cell = 0;                        // 2^P
  std::array<double, 3> period{};         // visible units; 0: the box does not repeat

  // `apart` becomes that of the partner's image in the 27 cells around own. False: there is none.
  bool meets(const std::array<double, 3>& own, std::array<double, 3>& apart) const;
};

struct BondList {
  // Bonds inside the block whose terms are made once for both ends, at the lower one: a group for each of the
  // block. And those with one end here, or seen from one: for the groups `own_group` that have any. Both
  // stand in one array of entries.
  std::vector<Entry> entries;
  std::vector<EntryGroup> both, own;
  std::vector<uint32_t> own_group;
  uint32_t window = kGroup;          // particles that entries of `both` lead ahead, at most
  std::vector<uint64_t> bond, twin;  // [slot]: index into the rows, from either end; kNoBond: there is none
  static constexpr uint64_t kNoBond = ~uint64_t{0};
  std::vector<uint64_t> far;   // index into the rows: the partner is too far to be known to this rank
  PaddedArray<uint32_t> kind;  // [slot], of the rows
  std::vector<PaddedArray<double>> numbers;  // [number][slot]
  static size_t slot(size_t entry, uint32_t lane) { return entry * kGroup + lane; }

  void build(const Block& block, const Particles& particles, const Index& index, const BondSpace& space,
             bool once, int number_count);
  // Whether the bond counts no more, for ever.
  bool is_broken(const graph::FixedProgram& program, const BondSpace& space, size_t slot) const;

 private:
  void add_kinds(const graph::BondRows& rows);
};

}  // namespace cuboct::emu
