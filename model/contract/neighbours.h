// SPDX-License-Identifier: MIT
// Pairs of particles nearer than a cutoff, by a grid of cells: the linked-cell method of Hockney and
// Eastwood, Computer Simulation Using Particles (1981), section 8-4.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

class CellList {
 public:
  // Space is open or periodic by axis; in periodic axes particles may stand outside the box. InputError where
  // a periodic extent is below 2 cutoffs: a particle would meet two images of another. Pairs are found up to
  // cutoff + skin; of those beyond the cutoff the nearest image alone.
  CellList(double cutoff, const Periodic& periodic, double skin = 0);

  // Sorts the particles into cells. O(N) in time and space, however far apart they are.
  // std::runtime_error where a position is not finite.
  void build(std::span<const Vec3> x);

  // Calls pair(i, j, d, r) once for each unordered pair at a distance 0 < r < cutoff + skin, with d = x[j] -
  // x[i] in m, of the nearest image. The order depends on the positions alone. `x` as given to build().
  template <class Pair>
  void for_each_pair(std::span<const Vec3> x, Pair&& pair) const;

  // The particles by cell, ascending in each.
  std::span<const uint32_t> order() const { return order_; }
  // Cells by number: that of x, and all that may hold something near a cell, itself included.
  int64_t cell_at(const Vec3& x) const { return index_of(cell_of(x)); }
  template <class Cell>
  void for_each_near(int64_t cell, Cell&& on) const {
    const std::array<int, 3> at{static_cast<int>(cell % count_[0]),
                                static_cast<int>(cell / count_[0] % count_[1]),
                                static_cast<int>(cell / count_[0] / count_[1])};
    for (int neighbour = 0; neighbour < 27; ++neighbour) {
      const std::array<int, 3> offset{neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1};
      std::array<int, 3> near{};
      bool exists = true;
      for (int axis = 0; axis < 3; ++axis) {
        near[axis] = at[axis] + offset[axis];
        const bool outside = near[axis] < 0 || near[axis] >= count_[axis];
        const bool wraps = periodic_.extent[axis] > 0 && count_[axis] > 1;
        if (outside && !wraps) exists = false;
        if (outside) near[axis] += near[axis] < 0 ? count_[axis] : -count_[axis];
      }
      if (exists) on(index_of(near));
    }
  }
  // Where a cell's particles begin and end in order().
  uint32_t begin_of(int64_t cell) const { return first_[cell]; }
  uint32_t end_of(int64_t cell) const { return first_[cell + 1]; }

  // The shortest vector from a to b in m, over images.
  Vec3 difference(const Vec3& a, const Vec3& b) const {
    Vec3 d = b - a;
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = periodic_.extent[axis];
      if (extent > 0 && std::abs(d[axis]) > extent / 2) d[axis] -= extent * std::round(d[axis] / extent);
    }
    return d;
  }

 private:
  std::array<int, 3> cell_of(const Vec3& x) const;
  int64_t index_of(const std::array<int, 3>& cell) const {
    return (int64_t{cell[2]} * count_[1] + cell[1]) * count_[0] + cell[0];
  }

  double range_;  // cutoff + skin
  Periodic periodic_;
  Vec3 origin_ = Vec3::Zero();  // of the grid
  Vec3 edge_ = Vec3::Ones();    // of a cell, at least the range where an axis has more than one cell
  std::array<int, 3> count_{1, 1,
                            1};  // cells; in a periodic axis 1 or at least 3, so that no cell is met twice
  std::vector<uint32_t> first_;  // [cell]: begin of its particles in order_; one more at the end
  std::vector<uint32_t> order_;  // particles by cell, ascending in each
};

template <class Pair>
void CellList::for_each_pair(std::span<const Vec3> x, Pair&& pair) const {
  const double range2 = range_ * range_;
  for (int64_t home = 0; home + 1 < static_cast<int64_t>(first_.size()); ++home) {
    if (first_[home] == first_[home + 1]) continue;
    for_each_near(home, [&](int64_t other) {
      for (uint32_t a = first_[home]; a < first_[home + 1]; ++a) {
        const uint32_t i = order_[a];
        for (uint32_t b = first_[other]; b < first_[other + 1]; ++b) {
          const uint32_t j = order_[b];
          if (j <= i) continue;
          const Vec3 d = difference(x[i], x[j]);
          const double r2 = d.squaredNorm();
          if (r2 >= range2 || r2 == 0) continue;
          pair(i, j, d, std::sqrt(r2));
        }
      }
    });
  }
}

}  // namespace cuboct
