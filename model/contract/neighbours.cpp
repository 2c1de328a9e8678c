// SPDX-License-Identifier: MIT
#include "model/contract/neighbours.h"

#include <fmt/format.h>

#include <stdexcept>

#include "model/base/error.h"

namespace cuboct {

CellList::CellList(double cutoff, const Periodic& periodic, double skin)
    : range_(cutoff + skin), periodic_(periodic) {
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = periodic.extent[axis];
    if (extent != 0 && !(extent >= 2 * cutoff)) {
      throw InputError(fmt::format("the periodic box is {:g} m long along {}, less than two cutoffs ({:g} m)",
                                   extent, "xyz"[axis], 2 * cutoff))
          .about({"box.size", "box.cells", "box", "particles.file"});
    }
  }
}

std::array<int, 3> CellList::cell_of(const Vec3& x) const {
  std::array<int, 3> cell;
  for (int axis = 0; axis < 3; ++axis) {
    double along = (x[axis] - origin_[axis]) / edge_[axis];
    // Rounding may leave `along` at either end of the box.
    if (periodic_.extent[axis] > 0) along -= count_[axis] * std::floor(along / count_[axis]);
    cell[axis] = std::clamp(static_cast<int>(along), 0, count_[axis] - 1);
  }
  return cell;
}

void CellList::build(std::span<const Vec3> x) {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (size_t i = 0; i < x.size(); ++i) {
    if (!x[i].allFinite()) throw std::runtime_error(fmt::format("particle {} has no finite position", i));
    low = i == 0 ? x[i] : low.cwiseMin(x[i]);
    high = i == 0 ? x[i] : high.cwiseMax(x[i]);
  }
  Vec3 extent;
  // More cells per particle than this would only be empty.
  const double wanted = 4.0 * static_cast<double>(x.size()) + 64;
  std::array<double, 3> count;
  for (int axis = 0; axis < 3; ++axis) {
    const bool ring = periodic_.extent[axis] > 0;
    origin_[axis] = ring ? periodic_.origin[axis] : low[axis];
    extent[axis] = ring ? periodic_.extent[axis] : high[axis] - low[axis];
    // A cell is a little larger than the range, so that rounding cannot part a pair by two cells.
    count[axis] = std::clamp(std::floor(extent[axis] / (range_ * (1 + 1e-9))), 1.0, wanted);
  }
  while (count[0] * count[1] * count[2] > wanted) {
    double& most = *std::max_element(count.begin(), count.end());
    most = std::floor(most / 2);
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (periodic_.extent[axis] > 0 && count[axis] < 3) count[axis] = 1;
    count_[axis] = static_cast<int>(count[axis]);
    edge_[axis] = extent[axis] > 0 ? extent[axis] / count[axis] : range_;
  }

  // Counting sort.
  std::vector<uint32_t> cell(x.size());
  first_.assign(static_cast<size_t>(count_[0]) * count_[1] * count_[2] + 1, 0);
  for (size_t i = 0; i < x.size(); ++i) {
    cell[i] = static_cast<uint32_t>(index_of(cell_of(x[i])));
    ++first_[cell[i] + 1];
  }
  for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  order_.resize(x.size());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (size_t i = 0; i < x.size(); ++i) order_[next[cell[i]]++] = static_cast<uint32_t>(i);
}

}  // namespace cuboct
