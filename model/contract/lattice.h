// SPDX-License-Identifier: MIT
// The cells of a scene and their 6-neighbour links. Sparse: memory and time grow with the cells that are
// listed (36 bytes each and 12 per row of them along x), not with the space that they span.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/base/vec.h"

namespace cuboct {

// Faces in the order of the links: -x, +x, -y, +y, -z, +z.
inline constexpr int kFaces = 6;
inline constexpr uint32_t kNoCell = 0xffffffffu;

class Lattice {
 public:
  Lattice() = default;
  // `cells`, deduplicated, plus those that keep the set closed: records and particles travel to a diagonal
  // neighbour by x, then y, then z, so the cells on that way must exist too. `period[a]` > 0 makes axis a a
  // ring of that many cells (at least 3, and every coordinate in [0, period)). Indices follow the order of
  // (z, y, x); cells that come in it are not sorted again.
  Lattice(std::vector<Cell> cells, Cell period);

  uint32_t size() const { return static_cast<uint32_t>(cells_.size()); }
  const Cell& cell(uint32_t cell) const { return cells_[cell]; }
  const Cell& period() const { return period_; }
  uint32_t neighbour(uint32_t cell, int face) const { return neighbour_[cell][face]; }
  // kNoCell where the lattice has no such cell.
  uint32_t find(const Cell& cell) const;
  // The up to 27 cells around `cell`, itself included, with their offsets.
  struct Near {
    uint32_t cell;
    Cell offset;
  };
  std::vector<Near> neighbourhood(uint32_t cell) const;

 private:
  // All cells of one z and y: [first, first of the next row), ascending in x. The last row is a sentinel.
  struct Row {
    int32_t z, y;
    uint32_t first;
  };
  struct Span {
    uint32_t begin = 0, end = 0;
  };

  Cell wrapped(Cell cell) const;
  size_t row_at(int32_t z, int32_t y) const;  // index into rows_; that of the sentinel where there is none
  uint32_t in_row(const Span& row, int32_t x) const;  // of a row that is not empty
  Span around(size_t row, int dz, int dy) const;  // the cells of the row beside that one; empty where none is
  bool neighbours_in_x(const Span& row, uint32_t at, int32_t x) const;
  void index_rows();
  void close();
  void missing_between(size_t row, int dz, int dy, std::vector<Cell>& missing) const;
  void link();

  Cell period_{};
  std::vector<Row> rows_;
  std::vector<Cell> cells_;
  std::vector<std::array<uint32_t, kFaces>> neighbour_;
};

}  // namespace cuboct
