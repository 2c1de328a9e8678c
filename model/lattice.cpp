// SPDX-License-Identifier: MIT
#include "model/lattice.h"

#include <algorithm>
#include <tuple>

namespace cuboct {
namespace {

bool before(const Cell& a, const Cell& b) { return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]); }

}  // namespace

Cell Lattice::wrapped(Cell cell) const {
  for (int a = 0; a < 3; ++a)
    if (period_[a] > 0) cell[a] = (cell[a] % period_[a] + period_[a]) % period_[a];
  return cell;
}

uint32_t Lattice::find(const Cell& cell) const {
  const Cell c = wrapped(cell);
  const auto it = std::lower_bound(cells_.begin(), cells_.end(), c, before);
  return it != cells_.end() && *it == c ? static_cast<uint32_t>(it - cells_.begin()) : kNoNode;
}

Lattice::Lattice(std::vector<Cell> cells, Cell period) : period_(period) {
  for (Cell& c : cells) c = wrapped(c);
  const auto settle = [&] {
    std::sort(cells.begin(), cells.end(), before);
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    cells_ = cells;
  };
  settle();
  // Close the set: a cell that is added may start further ways, so repeat until nothing is missing.
  for (bool grew = true; grew;) {
    std::vector<Cell> missing;
    for (const Cell& c : cells_)
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            if ((dx != 0) + (dy != 0) + (dz != 0) < 2) continue;
            if (find({c[0] + dx, c[1] + dy, c[2] + dz}) == kNoNode) continue;
            for (const Cell& way : {Cell{c[0] + dx, c[1], c[2]}, Cell{c[0] + dx, c[1] + dy, c[2]}})
              if (find(way) == kNoNode) missing.push_back(wrapped(way));
          }
    grew = !missing.empty();
    cells.insert(cells.end(), missing.begin(), missing.end());
    settle();
  }
  neighbour_.resize(cells_.size());
  for (uint32_t node = 0; node < size(); ++node)
    for (int face = 0; face < kFaces; ++face) {
      Cell c = cells_[node];
      c[face / 2] += face % 2 ? 1 : -1;
      neighbour_[node][face] = find(c);
    }
}

std::vector<Lattice::Near> Lattice::neighbourhood(uint32_t node) const {
  const auto hop = [this](uint32_t from, int axis, int way) {
    return way == 0 || from == kNoNode ? from : neighbour_[from][2 * axis + (way > 0)];
  };
  std::vector<Near> near;
  near.reserve(27);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const uint32_t other = hop(hop(hop(node, 0, dx), 1, dy), 2, dz);
        if (other != kNoNode) near.push_back({other, {dx, dy, dz}});
      }
  return near;
}

}  // namespace cuboct
