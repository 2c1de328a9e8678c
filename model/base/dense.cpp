// SPDX-License-Identifier: MIT
#include <Eigen/QR>

#include "model/base/dense_solvers.h"

namespace cuboct {

template ColumnOf<Mat3> eigenvalues(const Mat3&);
template Eigensystem<Mat3> eigensystem(const Mat3&);
template Eigensystem<Eigen::MatrixXd> eigensystem(const Eigen::MatrixXd&);

Vec3 least_squares(const Mat3& matrix, const Vec3& value) {
  return matrix.completeOrthogonalDecomposition().solve(eigen(value));
}

}  // namespace cuboct
