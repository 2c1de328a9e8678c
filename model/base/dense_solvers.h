// SPDX-License-Identifier: MIT
// The templates of dense.h, for the files that instantiate them.
#pragma once

#include <Eigen/Eigenvalues>

#include "model/base/dense.h"

namespace cuboct {

template <typename Matrix>
ColumnOf<Matrix> eigenvalues(const Matrix& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

template <typename Matrix>
Eigensystem<Matrix> eigensystem(const Matrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace cuboct
