// SPDX-License-Identifier: MIT
// Matrices of three by three real numbers, which are Eigen's, with vectors that are not.
#pragma once
#include <Eigen/Core>

#include "model/base/vec.h"

namespace cuboct {

using Mat3 = Eigen::Matrix3d;

inline Eigen::Map<const Eigen::Vector3d> eigen(const Vec3& v) {
  return Eigen::Map<const Eigen::Vector3d>(v.data());
}
inline Eigen::Map<Eigen::Vector3d> eigen(Vec3& v) { return Eigen::Map<Eigen::Vector3d>(v.data()); }

inline Mat3 diagonal(const Vec3& v) { return eigen(v).asDiagonal(); }

template <class Matrix>
Vec3 operator*(const Eigen::MatrixBase<Matrix>& m, const Vec3& v) {
  return m * eigen(v);
}
template <class Matrix>
Vec3 operator*(const Eigen::DiagonalBase<Matrix>& m, const Vec3& v) {
  return m * eigen(v);
}
inline Mat3 operator*(const Vec3& a, const Vec3::Row& b) {
  Mat3 out;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) out(i, j) = a[i] * b.column[j];
  return out;
}

}  // namespace cuboct
