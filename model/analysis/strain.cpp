// SPDX-License-Identifier: MIT
#include "model/analysis/strain.h"

#include <algorithm>
#include <numeric>

#include "model/base/dense.h"
#include "model/base/parallel.h"
#include "model/contract/neighbours.h"

namespace cuboct {

StrainMeter::StrainMeter(const std::vector<Vec3>& initial, const Periodic& periodic, double radius)
    : initial_(initial), periodic_(periodic), present_box_(periodic), first_(initial.size() + 1, 0) {
  CellList cells(radius, periodic);
  cells.build(initial);
  cells.for_each_pair(initial, [&](uint32_t i, uint32_t j, const Vec3&, double) {
    ++first_[i + 1];
    ++first_[j + 1];
  });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  neighbours_.resize(first_.back());
  // first_[i] moves on to the end of i's neighbours, which is where those of i + 1 begin.
  cells.for_each_pair(initial, [&](uint32_t i, uint32_t j, const Vec3&, double) {
    neighbours_[first_[i]++] = j;
    neighbours_[first_[j]++] = i;
  });
  std::copy_backward(first_.begin(), first_.end() - 1, first_.end());
  first_.front() = 0;
}

Mat3 StrainMeter::gradient(size_t i, const std::vector<Vec3>& present) const {
  // Least squares for A = F - 1 in  du = A dx : A = (sum du dx^T) (sum dx dx^T)^+ . The pseudo-inverse is the
  // least-norm answer, so unseen directions get A = 0.
  Mat3 moved = Mat3::Zero(), shape = Mat3::Zero();
  for (size_t k = first_[i]; k < first_[i + 1]; ++k) {
    const uint32_t j = neighbours_[k];
    const Vec3 before = nearest_image(initial_[j] - initial_[i], periodic_);
    const Vec3 after = nearest_image(present[j] - present[i], present_box_);
    moved += (after - before) * before.transpose();
    shape += before * before.transpose();
  }
  const auto [values, vectors] = eigensystem(shape);
  Vec3 inverse = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (values[k] > 1e-6 * values[2]) inverse[k] = 1 / values[k];
  return Mat3::Identity() + moved * vectors * eigen(inverse).asDiagonal() * vectors.transpose();
}

std::vector<LocalStrain> StrainMeter::measure(const std::vector<Vec3>& present) const {
  std::vector<LocalStrain> strains(initial_.size());
  for (size_t i = 0; i < strains.size(); ++i) {
    LocalStrain& strain = strains[i];
    strain.neighbours = static_cast<int>(first_[i + 1] - first_[i]);
    strain.gradient = gradient(i, present);
    for (size_t k = first_[i]; k < first_[i + 1]; ++k) {
      const uint32_t j = neighbours_[k];
      const Vec3 before = nearest_image(initial_[j] - initial_[i], periodic_);
      const Vec3 after = nearest_image(present[j] - present[i], present_box_);
      strain.residual += (after - strain.gradient * before).squaredNorm();
    }
  }
  return strains;
}

std::vector<double> StrainMeter::axial(const std::vector<Vec3>& present, int axis) const {
  std::vector<double> strains(initial_.size());
  for_each_range(strains.size(), 10'000, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) strains[i] = LocalStrain{gradient(i, present), 0, 0}.axial(axis);
  });
  return strains;
}

uint32_t StrainMeter::broken(size_t i, const std::vector<Vec3>& present, const Reach& reach) const {
  uint32_t count = 0;
  for (size_t k = first_[i]; k < first_[i + 1]; ++k) {
    const uint32_t j = neighbours_[k];
    const double end = reach(static_cast<uint32_t>(i), j);
    const auto beyond = [&](const std::vector<Vec3>& x, const Periodic& box) {
      return nearest_image(x[j] - x[i], box).squaredNorm() > end * end;
    };
    count += beyond(present, present_box_) && !beyond(initial_, periodic_);
  }
  return count;
}

std::vector<uint32_t> StrainMeter::broken(const std::vector<Vec3>& present, const Reach& reach) const {
  std::vector<uint32_t> counts(initial_.size());
  for_each_range(counts.size(), 10'000, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) counts[i] = broken(i, present, reach);
  });
  return counts;
}

std::vector<Deformation> StrainMeter::deformations(const std::vector<Vec3>& present, int axis,
                                                   const Reach& reach) const {
  std::vector<Deformation> all(initial_.size());
  for_each_range(all.size(), 10'000, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const LocalStrain local{gradient(i, present), 0, 0};
      const Eigen::Matrix3f e = local.lagrangian().cast<float>();
      all[i] = {local.axial(axis),
                {e(0, 0), e(1, 1), e(2, 2), e(0, 1), e(0, 2), e(1, 2)},
                broken(i, present, reach)};
    }
  });
  return all;
}

}  // namespace cuboct
