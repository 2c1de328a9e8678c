// SPDX-License-Identifier: MIT
#include "model/base/dense_solvers.h"

namespace cuboct {

template ColumnOf<Mat3> eigenvalues(const Mat3&);
template Eigensystem<Mat3> eigensystem(const Mat3&);
template Eigensystem<Eigen::MatrixXd> eigensystem(const Eigen::MatrixXd&);

}  // namespace cuboct
