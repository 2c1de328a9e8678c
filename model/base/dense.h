// SPDX-License-Identifier: MIT
// Eigen's decompositions of dense matrices, compiled once: a file that includes them itself takes two to
// twenty seconds more. Matrix: Eigen::Matrix2d, Mat3, Matrix6, Eigen::MatrixXd.
#pragma once

#include "model/base/mat3.h"

namespace cuboct {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

template <typename Matrix>
using ColumnOf = Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1>;

// Of a symmetric matrix, whose lower half is read; ascending.
template <typename Matrix>
ColumnOf<Matrix> eigenvalues(const Matrix& symmetric);

template <typename Matrix>
struct Eigensystem {
  ColumnOf<Matrix> values;  // ascending; their last digits may differ from those of eigenvalues()
  Matrix vectors;           // of length 1, in columns
};
template <typename Matrix>
Eigensystem<Matrix> eigensystem(const Matrix& symmetric);

Matrix6 inverse(const Matrix6& matrix);

// The shortest x with matrix x = value, or of least squares where there is none.
Vec3 least_squares(const Mat3& matrix, const Vec3& value);

}  // namespace cuboct
