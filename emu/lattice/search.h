// SPDX-License-Identifier: MIT
// Finds the particles around a point, over the nodes' rows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/lattice/block.h"
#include "emu/lattice/members.h"
#include "model/lattice.h"

namespace cuboct::emu {

// Fractional bits of a cell edge in which pairs are searched and displacements are measured.
inline constexpr int kCoarse = 16;
inline int32_t coarse(double x, int position_frac) {
  const auto whole = static_cast<int64_t>(x);
  return static_cast<int32_t>(position_frac >= kCoarse ? whole >> (position_frac - kCoarse)
                                                       : whole << (kCoarse - position_frac));
}

// Neighbours in x, y and z of a row of nodes: nodes of one (y, z) stand one after another in a Lattice, so the
// particles of a stretch of a row are a stretch of an array.
class Rows {
 public:
  explicit Rows(const Lattice& lattice);

  static constexpr int kReach = 2;  // cells
  // The row `dy`, `dz` beside that of `node`, and the node range in it of x from `low` to `high`.
  uint32_t row_of(uint32_t node) const { return row_of_[node]; }
  // kNoNode where there is none.
  uint32_t near(uint32_t row, int dy, int dz) const {
    return near_[row][static_cast<size_t>((dz + kReach) * (2 * kReach + 1) + dy + kReach)];
  }
  struct Range {
    uint32_t begin, end;
  };
  Range nodes(uint32_t row, int32_t low, int32_t high) const;

 private:
  struct Row {
    uint32_t begin, end;
  };
  const Lattice& lattice_;
  std::vector<Row> rows_;
  std::vector<uint32_t> row_of_;
  std::vector<std::array<uint32_t, (2 * kReach + 1) * (2 * kReach + 1)>> near_;
};

// The particles as they stood when the list was made, by node and slot: coarse coordinates (modulo 2^32: only
// differences over a few cells are used).
struct Snapshot {
  std::vector<uint32_t> first;  // nodes + 1
  PaddedArray<int32_t> x, y, z;
  PaddedArray<uint32_t> particle;
};

// Calls see(particle, shift) for each particle within `reach` cells (at most kReach) of one in `node` that
// stood at (x, y, z) in the snapshot, itself included; `shift` as in Entry.
class Search {
 public:
  Search(const Lattice& lattice, const Rows& rows, const Snapshot& snapshot, double reach);
  struct Hit {
    uint32_t particle;
    uint8_t shift;
  };
  // The hits are valid until the next call.
  const std::vector<Hit>& around(uint32_t node, int32_t x, int32_t y, int32_t z);

 private:
  void add(Rows::Range nodes, int32_t x, int32_t y, int32_t z, uint8_t shift);
  const Lattice& lattice_;
  const Rows& rows_;
  const Snapshot& snapshot_;
  int32_t reach_;    // coarse, rounded up
  float reach2_;
  std::vector<Hit> hits_;
  std::vector<uint32_t> found_;
};

// The positions k in [0, count) with (x[k] - at[0])^2 + ... <= reach2, up to the rounding of floats; `found` has
// room for count + 16. Returns how many.
uint32_t within(const int32_t* x, const int32_t* y, const int32_t* z, uint32_t count, const int32_t at[3],
                float reach2, uint32_t* found);

}  // namespace cuboct::emu
