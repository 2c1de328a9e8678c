// SPDX-License-Identifier: MIT
// Who is near whom, by a grid of cells: the walk of all lists of pairs.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "model/contract/neighbours.h"
#include "model/real/pair_kernel.h"

namespace cuboct {

class NearWalk {
 public:
  // `x` by id, as `cells` were built of them; a reference to `cells` is kept.
  NearWalk(const CellList& cells, const std::vector<Vec3>& x, const Periodic& periodic) : cells_(cells) {
    for (int axis = 0; axis < 3; ++axis) {
      box_[axis] = periodic.extent[axis];
      at_[axis].assign(x.size() + kNearerSpill, 0);
    }
    names_.resize(x.size());
    for (uint32_t slot = 0; slot < x.size(); ++slot) {
      const uint32_t id = cells.order()[slot];
      for (int axis = 0; axis < 3; ++axis) at_[axis][slot] = x[id][axis];
      names_[slot] = uint64_t{id} << 32 | slot;
    }
  }

  // For the slots [begin, end) of the cells' order: calls see(slot, near), where `near` are the particles
  // nearer than `range` (m), itself among them: id << 32 | slot, ascending.
  template <class See>
  void operator()(double range, size_t begin, size_t end, const See& see) const {
    std::vector<NearRange> ranges;  // of slots, of the cells around `home`
    std::vector<uint64_t> found;
    int64_t home = -1;
    for (size_t slot = begin; slot < end; ++slot) {
      const Vec3 x(at_[0][slot], at_[1][slot], at_[2][slot]);
      if (const int64_t cell = cells_.cell_at(x); cell != home) {
        home = cell;
        ranges.clear();
        size_t candidates = 0;
        cells_.for_each_near(cell, [&](int64_t other) {
          const size_t first = cells_.begin_of(other), last = cells_.end_of(other);
          if (first == last) return;
          candidates += last - first;
          // Cells in a row along x lie one after the other.
          if (!ranges.empty() && ranges.back().end == first)
            ranges.back().end = last;
          else
            ranges.push_back({first, last});
        });
        if (found.size() < candidates + kNearerSpill) found.resize(candidates + kNearerSpill);
      }
      const size_t n = nearer(at_, names_, ranges, x, box_, range * range, found);
      see(slot, std::span<const uint64_t>(found.data(), n));
    }
  }

 private:
  const CellList& cells_;
  std::array<double, 3> box_{};  // m, 0 along open axes
  std::vector<double> at_[3];    // by slot
  std::vector<uint64_t> names_;
};

}  // namespace cuboct
