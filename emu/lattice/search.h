// SPDX-License-Identifier: MIT
// Finds the particles around a point, over the cells' rows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/lattice/snapshot.h"
#include "model/contract/lattice.h"

namespace cuboct::emu {

// Neighbours in x, y and z of a row of cells: cells of one (y, z) stand one after another in a Lattice, so
// the particles of a stretch of a row are a stretch of an array.
class Rows {
 public:
  explicit Rows(const Lattice& lattice);

  static constexpr int kReach = 2;  // cells
  // The row `dy`, `dz` beside that of `cell`, and the cell range in it of x from `low` to `high`.
  uint32_t row_of(uint32_t cell) const { return row_of_[cell]; }
  // kNoCell where there is none.
  uint32_t near(uint32_t row, int dy, int dz) const {
    return near_[row][static_cast<size_t>(dz + kReach) * (2 * kReach + 1) + static_cast<size_t>(dy + kReach)];
  }
  struct Range {
    uint32_t begin, end;
  };
  uint32_t count() const { return static_cast<uint32_t>(rows_.size()); }
  Range row(uint32_t row) const { return rows_[row]; }
  // Whether its cells stand without a gap.
  bool whole(uint32_t row) const;
  Range cells(uint32_t row, int32_t low, int32_t high) const;

 private:
  const Lattice& lattice_;
  std::vector<Range> rows_;
  std::vector<uint32_t> row_of_;
  std::vector<std::array<uint32_t, (2 * kReach + 1) * (2 * kReach + 1)>> near_;
};

// Finds the particles within `reach` cells (at most Rows::kReach) of a point: in the bins, or, where only a
// few points are looked at, among the members of the cells as the snapshot has them.
class Search {
 public:
  Search(const Lattice& lattice, const Rows& rows, double reach, const Bins& bins);
  Search(const Lattice& lattice, const Rows& rows, double reach, const Members& members, const Index& index,
         const Snapshot& snapshot);
  struct Hit {
    uint32_t particle;
    uint8_t shift;  // as in Entry
  };
  // Around the point `at` of `cell`. The hits are valid until the next call.
  const std::vector<Hit>& around(uint32_t cell, const std::array<int32_t, 3>& at);

 private:
  Search(const Lattice& lattice, const Rows& rows, double reach);
  void add(Rows::Range cells, const std::array<int32_t, 3>& at, uint8_t shift);
  const Lattice& lattice_;
  const Rows& rows_;
  const Bins* bins_ = nullptr;
  const Members* members_ = nullptr;
  const Index* index_ = nullptr;
  const Snapshot* snapshot_ = nullptr;
  int32_t reach_;  // coarse, rounded up
  float reach2_;
  std::vector<Hit> hits_;
  std::vector<uint32_t> found_;
};

// The positions k in [0, count) with (x[k] - at[0])^2 + ... <= reach2, up to the rounding of floats; `found`
// has room for count + 16. Returns how many.
uint32_t within(const int32_t* x, const int32_t* y, const int32_t* z, uint32_t count, const int32_t at[3],
                float reach2, uint32_t* found);

}  // namespace cuboct::emu
