// SPDX-License-Identifier: MIT
// Vectors and matrices of three dimensions, in real numbers and in integers.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace cuboct {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Int3 = std::array<int64_t, 3>;  // fixed-point triples; the unit stands where it is used
using Cell = std::array<int32_t, 3>;  // a cell's integer coordinates in the lattice

}  // namespace cuboct
