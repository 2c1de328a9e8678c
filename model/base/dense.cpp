// SPDX-License-Identifier: MIT
#include "model/base/dense.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace cuboct {

template <typename Matrix>
ColumnOf<Matrix> eigenvalues(const Matrix& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}
template ColumnOf<Eigen::Matrix2d> eigenvalues(const Eigen::Matrix2d&);
template ColumnOf<Mat3> eigenvalues(const Mat3&);
template ColumnOf<Matrix6> eigenvalues(const Matrix6&);
template ColumnOf<Eigen::MatrixXd> eigenvalues(const Eigen::MatrixXd&);

template <typename Matrix>
Eigensystem<Matrix> eigensystem(const Matrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}
template Eigensystem<Eigen::Matrix2d> eigensystem(const Eigen::Matrix2d&);
template Eigensystem<Mat3> eigensystem(const Mat3&);
template Eigensystem<Eigen::MatrixXd> eigensystem(const Eigen::MatrixXd&);

Matrix6 inverse(const Matrix6& matrix) { return matrix.inverse(); }

}  // namespace cuboct
