// SPDX-License-Identifier: MIT
// Of what only studies decompose.
#include <Eigen/LU>

#include "model/base/dense_solvers.h"

namespace cuboct {

template ColumnOf<Eigen::Matrix2d> eigenvalues(const Eigen::Matrix2d&);
template ColumnOf<Matrix6> eigenvalues(const Matrix6&);
template ColumnOf<Eigen::MatrixXd> eigenvalues(const Eigen::MatrixXd&);
template Eigensystem<Eigen::Matrix2d> eigensystem(const Eigen::Matrix2d&);

Matrix6 inverse(const Matrix6& matrix) { return matrix.inverse(); }

}  // namespace cuboct
