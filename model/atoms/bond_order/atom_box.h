// SPDX-License-Identifier: MIT
// The space that atoms are in: three edges, along each of which it repeats or does not.
#pragma once

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "model/base/mat3.h"

namespace cuboct {

struct AtomBox {
  Mat3 edges =
      Mat3::Identity();  // columns; of one unit of length. Regular: those that do not repeat give a direction
  std::array<bool, 3> periodic{false, false, false};

  double volume() const { return std::abs(edges.determinant()); }
};

}  // namespace cuboct
