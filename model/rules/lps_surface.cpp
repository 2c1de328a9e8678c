// SPDX-License-Identifier: MIT
#include "model/rules/lps_surface.h"

#include "model/base/dense.h"

namespace cuboct {

Mat3 shape_of(const LpsMaterial& material, double whole, const SurfaceSums& sums) {
  constexpr double kNone = 1e-9;  // of the largest second moment
  const auto [values, vectors] = eigensystem<Mat3>(material.dimensions / whole * sums.second);
  Vec3 inverse = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    if (values[k] > kNone * values[2] && values[2] > kNone) inverse[k] = 1 / values[k];
  return vectors * eigen(inverse).asDiagonal() * vectors.transpose();
}

}  // namespace cuboct
