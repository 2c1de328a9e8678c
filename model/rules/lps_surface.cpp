// SPDX-License-Identifier: MIT
#include "model/rules/lps_surface.h"

#include <Eigen/Eigenvalues>

namespace cuboct {

Mat3 shape_of(const LpsMaterial& material, double whole, const SurfaceSums& sums) {
  constexpr double kNone = 1e-9;  // of the largest second moment
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(material.dimensions / whole * sums.second);
  const Vec3 values = solver.eigenvalues();
  Vec3 inverse = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (values[k] > kNone * values[2] && values[2] > kNone) inverse[k] = 1 / values[k];
  return solver.eigenvectors() * inverse.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace cuboct
