// SPDX-License-Identifier: MIT
// Who meets whom: of each particle of a block its partners. Pairs of the pair law's lists (pair_list.h) stand
// in vectors of their own; these rows take any terms.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/block.h"
#include "emu/lattice/search.h"
#include "model/graph/bond_rows.h"

namespace cuboct::emu {

// A partner: its index, and above it the image that is met, an index into Particles::shift.
struct Partner {
  static constexpr int kIndexBits = 27;
  static constexpr uint32_t kMost = uint32_t{1} << kIndexBits;
  static uint32_t of(uint32_t index, uint8_t shift) { return index | uint32_t{shift} << kIndexBits; }
  static uint32_t index(uint32_t partner) { return partner & (kMost - 1); }
  static uint8_t shift(uint32_t partner) { return static_cast<uint8_t>(partner >> kIndexBits); }
};

// What a bonded program keeps of bonds (graph::BondRows): by number, [bond].
using BondNumbers = std::vector<PaddedArray<double>>;

class PartnerList {
 public:
  // The rows of bonds, for as long as particles are stored as they are.
  void build(const Block& block, const Particles& particles, const Index& index, const graph::BondRows& rows);
  // The particles within the search's reach. `once`: a pair inside the block stands at its particle of lower
  // index alone.
  void build(const Block& block, const Particles& particles, int position_frac, bool once, Search search);
  // Puts those within `reach` (P fractional bits) first in their rows.
  void prune(const Block& block, const Particles& particles, double reach);

  struct Row {
    uint32_t begin, near, end;
    uint64_t bond;  // of the first partner
  };
  const Row& row(uint32_t particle_in_block) const { return rows_[particle_in_block]; }
  const uint32_t* partners() const { return partners_.data(); }

 private:
  std::vector<Row> rows_;
  std::vector<uint32_t> partners_;
};

}  // namespace cuboct::emu
