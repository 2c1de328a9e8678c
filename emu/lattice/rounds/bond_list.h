// SPDX-License-Identifier: MIT
// Of a bonded program: a block's bonds as entries (block.h), each from its particle's end, for as long as
// particles are stored as they are. What rounds keep of a bond stands at the slot of its entry's lane, so a
// vector reads it as it reads positions.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/snapshot.h"
#include "model/graph/bond_rows.h"

namespace cuboct::emu {

struct BondList {
  PairList pairs;              // a group for each of the block
  std::vector<uint64_t> bond;  // [slot]: index into the rows; kNoBond where the lane is not one of the entry
  static constexpr uint64_t kNoBond = ~uint64_t{0};
  PaddedArray<uint32_t> kind;                        // [slot], of the rows
  std::vector<PaddedArray<double>> numbers, before;  // [number][slot]: now, and when the step began
  static size_t slot(size_t entry, uint32_t lane) { return entry * kGroup + lane; }

  void build(const Block& block, const Particles& particles, const Index& index, const graph::BondRows& rows,
             const std::array<double, 3>& period, int number_count);
};

}  // namespace cuboct::emu
