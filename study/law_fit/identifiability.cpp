// SPDX-License-Identifier: MIT
#include "study/law_fit/identifiability.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace cuboct::fit {

// With S the slopes in the metric of curve_error (weights of the trapezoidal rule, over the target's norm) a
// move u changes the curve by |S u|. With S = U diag(s) V^T the moves that change it by `error` are an
// ellipsoid with the half axes error/s along V's columns; its half extent along parameter j is
// error sqrt(sum_k (V_jk/s_k)^2).
Identifiability identifiability(const std::vector<Slopes>& slopes, const std::vector<double>& target,
                                double error) {
  const auto rows = static_cast<Eigen::Index>(target.size()),
             columns = static_cast<Eigen::Index>(slopes.size());
  Eigen::MatrixXd s(rows, columns);
  double norm = 0;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double weight = i == 0 || i + 1 == rows ? 0.5 : 1;
    norm += weight * target[static_cast<size_t>(i)] * target[static_cast<size_t>(i)];
    for (Eigen::Index j = 0; j < columns; ++j)
      s(i, j) = std::sqrt(weight) * slopes[static_cast<size_t>(j)][static_cast<size_t>(i)];
  }
  s /= std::sqrt(norm);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(s, Eigen::ComputeThinV);
  Identifiability out;
  out.uncertainty.assign(slopes.size(), 0);
  for (Eigen::Index k = 0; k < svd.singularValues().size(); ++k) {
    Eigen::VectorXd v = svd.matrixV().col(k);
    Eigen::Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    if (v[largest] < 0) v = -v;
    const double change = svd.singularValues()[k];
    out.combinations.push_back({change, {v.begin(), v.end()}});
    const double move = std::min(1.0, error / change);  // bounds end it
    for (size_t j = 0; j < slopes.size(); ++j)
      out.uncertainty[j] = std::hypot(out.uncertainty[j], out.combinations.back().weights[j] * move);
  }
  return out;
}

}  // namespace cuboct::fit
