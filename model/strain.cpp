// SPDX-License-Identifier: MIT
#include "model/strain.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "model/neighbours.h"

namespace cuboct {
Vec3 nearest_image(Vec3 d, const Periodic& periodic) {
  for (int axis = 0; axis < 3; ++axis)
    if (periodic.extent[axis] > 0)
      d[axis] -= periodic.extent[axis] * std::round(d[axis] / periodic.extent[axis]);
  return d;
}

StrainMeter::StrainMeter(const std::vector<Vec3>& initial, const Periodic& periodic, double radius)
    : initial_(initial), periodic_(periodic), neighbours_(initial.size()) {
  CellList cells(radius, periodic);
  cells.build(initial);
  cells.for_each_pair(initial, [&](uint32_t i, uint32_t j, const Vec3&, double) {
    neighbours_[i].push_back(j);
    neighbours_[j].push_back(i);
  });
}

std::vector<LocalStrain> StrainMeter::measure(const std::vector<Vec3>& present) const {
  std::vector<LocalStrain> strains(initial_.size());
  for (size_t i = 0; i < strains.size(); ++i) {
    LocalStrain& strain = strains[i];
    strain.neighbours = static_cast<int>(neighbours_[i].size());
    // Least squares for A = F - 1 in  du = A dx : A = (sum du dx^T) (sum dx dx^T)^+ . The pseudo-inverse is
    // the least-norm answer, so unseen directions get A = 0.
    Mat3 moved = Mat3::Zero(), shape = Mat3::Zero();
    for (const uint32_t j : neighbours_[i]) {
      const Vec3 before = nearest_image(initial_[j] - initial_[i], periodic_);
      const Vec3 after = nearest_image(present[j] - present[i], periodic_);
      moved += (after - before) * before.transpose();
      shape += before * before.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(shape);
    Vec3 inverse = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (axes.eigenvalues()[k] > 1e-6 * axes.eigenvalues()[2]) inverse[k] = 1 / axes.eigenvalues()[k];
    strain.gradient += moved * axes.eigenvectors() * inverse.asDiagonal() * axes.eigenvectors().transpose();
    for (const uint32_t j : neighbours_[i]) {
      const Vec3 before = nearest_image(initial_[j] - initial_[i], periodic_);
      const Vec3 after = nearest_image(present[j] - present[i], periodic_);
      strain.residual += (after - strain.gradient * before).squaredNorm();
    }
  }
  return strains;
}

}  // namespace cuboct
