// SPDX-License-Identifier: MIT
// The nodes of a scene and their 6-neighbour links. Sparse: only listed cells have a node.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/vec.h"

namespace cuboct {

// Faces in the order of the links: -x, +x, -y, +y, -z, +z.
inline constexpr int kFaces = 6;
inline constexpr uint32_t kNoNode = 0xffffffffu;

class Lattice {
 public:
  Lattice() = default;
  // The nodes are `cells`, deduplicated, plus the cells that keep the set closed: records and particles
  // travel to a diagonal neighbour by x, then y, then z, so the cells on that way must exist too. `period[a]`
  // > 0 makes axis a a ring of that many cells (at least 3, and every coordinate in [0, period)). Node
  // indices follow the order of (z, y, x).
  Lattice(std::vector<Cell> cells, Cell period);

  uint32_t size() const { return static_cast<uint32_t>(cells_.size()); }
  const Cell& cell(uint32_t node) const { return cells_[node]; }
  const Cell& period() const { return period_; }
  uint32_t neighbour(uint32_t node, int face) const { return neighbour_[node][face]; }
  // kNoNode where the cell has no node.
  uint32_t find(const Cell& cell) const;
  // All up to 27 nodes around `node`, itself included, with their offsets.
  struct Near {
    uint32_t node;
    Cell offset;
  };
  std::vector<Near> neighbourhood(uint32_t node) const;

 private:
  Cell wrapped(Cell cell) const;
  Cell period_{};
  std::vector<Cell> cells_;
  std::vector<std::array<uint32_t, kFaces>> neighbour_;
};

}  // namespace cuboct
