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

#include "model/rule.h"

namespace cuboct {

class CellList {
 public:
  // Space is open or periodic by axis; in periodic axes particles may stand outside the box. InputError where
  // a periodic extent is below 2 cutoffs: a particle would meet two images of another.
  CellList(double cutoff, const Periodic& periodic);

  // Sorts the particles into cells. O(N) in time and space, however far apart they are.
  // std::runtime_error where a position is not finite.
  void build(std::span<const Vec3> x);

  // Calls pair(i, j, d, r) once for each unordered pair at a distance 0 < r < cutoff, with d = x[j] - x[i] in
  // m, of the nearest image. The order depends on the positions alone. `x` as given to build().
  template <class Pair>
  void for_each_pair(std::span<const Vec3> x, Pair&& pair) const;

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

  double cutoff_;
  Periodic periodic_;
  Vec3 origin_ = Vec3::Zero();  // of the grid
  Vec3 edge_ = Vec3::Ones();    // of a cell, at least the cutoff where an axis has more than one cell
  std::array<int, 3> count_{1, 1,
                            1};  // cells; in a periodic axis 1 or at least 3, so that no cell is met twice
  std::vector<uint32_t> first_;  // [cell]: begin of its particles in order_; one more at the end
  std::vector<uint32_t> order_;  // particles by cell, ascending in each
};

template <class Pair>
void CellList::for_each_pair(std::span<const Vec3> x, Pair&& pair) const {
  std::array<int, 3> at{}, near{};
  for (at[2] = 0; at[2] < count_[2]; ++at[2]) {
    for (at[1] = 0; at[1] < count_[1]; ++at[1]) {
      for (at[0] = 0; at[0] < count_[0]; ++at[0]) {
        const int64_t home = index_of(at);
        if (first_[home] == first_[home + 1]) continue;
        for (int neighbour = 0; neighbour < 27; ++neighbour) {
          const std::array<int, 3> offset{neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1};
          bool exists = true;
          for (int axis = 0; axis < 3; ++axis) {
            near[axis] = at[axis] + offset[axis];
            const bool outside = near[axis] < 0 || near[axis] >= count_[axis];
            const bool wraps = periodic_.extent[axis] > 0 && count_[axis] > 1;
            if (outside && !wraps) exists = false;
            if (outside) near[axis] += near[axis] < 0 ? count_[axis] : -count_[axis];
          }
          if (!exists) continue;
          const int64_t other = index_of(near);
          for (uint32_t a = first_[home]; a < first_[home + 1]; ++a) {
            const uint32_t i = order_[a];
            for (uint32_t b = first_[other]; b < first_[other + 1]; ++b) {
              const uint32_t j = order_[b];
              if (j <= i) continue;
              const Vec3 d = difference(x[i], x[j]);
              const double r2 = d.squaredNorm();
              if (r2 >= cutoff_ * cutoff_ || r2 == 0) continue;
              pair(i, j, d, std::sqrt(r2));
            }
          }
        }
      }
    }
  }
}

}  // namespace cuboct
