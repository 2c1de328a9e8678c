// SPDX-License-Identifier: MIT
#include "study/learn/wave_operator.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/rules/lps.h"
#include "model/rules/quadrature.h"

namespace cuboct::learn {
WaveOperator::WaveOperator(const Grid& grid, double horizon) : grid_(grid), horizon_(horizon * grid.step()) {
  const int most = static_cast<int>(std::ceil(horizon)) + 1;
  if (2 * horizon >= grid.points)
    throw InputError(
        fmt::format("a horizon of {:g} spacings meets itself around {} points", horizon, grid.points),
        "more points, or a smaller horizon");
  std::vector<Vec3> around;
  for (int j = -most; j <= most; ++j)
    for (int i = -most; i <= most; ++i) {
      const Vec3 r(i * grid.spacing[0], j * grid.spacing[1], 0);
      if ((i != 0 || j != 0) && r.norm() < horizon_ * (1 + 1e-6)) around.push_back(r);
    }
  const auto weights = ball_weights(around, horizon_, 2, LpsMaterial{}.order);
  if (!weights)
    throw InputError(fmt::format("{} points within a horizon of {:g} spacings are too few for its quadrature",
                                 around.size(), horizon),
                     "a larger horizon");
  weight_ = Eigen::Map<const Eigen::VectorXd>(weights->data(), static_cast<Eigen::Index>(weights->size()));
  length_.resize(weight_.size());
  for (size_t p = 0; p < around.size(); ++p)
    offset_.emplace_back(eigen(around[p]).head<2>()),
        length_[static_cast<Eigen::Index>(p)] = around[p].norm();
  const int n = grid.points;
  for (int b = 0; b < n; ++b)
    for (int a = 0; a < n; ++a) {
      if (a == 0 && b == 0) continue;
      const double pi = std::numbers::pi;
      wave_.emplace_back(2 * pi * a / (n * grid.spacing[0]), 2 * pi * b / (n * grid.spacing[1]));
      even_.push_back(2 * a % n == 0 && 2 * b % n == 0);
      double square = 0;
      for (int axis = 0; axis < 2; ++axis)
        square += (2 - 2 * std::cos(wave_.back()[axis] * grid.spacing[axis])) /
                  (grid.spacing[axis] * grid.spacing[axis]);
      square_.push_back(square);
    }
  sine_.resize(weight_.size(), static_cast<Eigen::Index>(wave_.size()));
  one_less_cosine_.resizeLike(sine_);
  for (Eigen::Index k = 0; k < sine_.cols(); ++k)
    for (Eigen::Index p = 0; p < sine_.rows(); ++p) {
      const double phase = wave_[static_cast<size_t>(k)].dot(offset_[static_cast<size_t>(p)]);
      sine_(p, k) = std::sin(phase), one_less_cosine_(p, k) = 1 - std::cos(phase);
    }
}

Eigen::VectorXd WaveOperator::kernel_at(double alpha, const std::vector<double>& D,
                                        Eigen::MatrixXd* slope) const {
  Eigen::VectorXd K = Eigen::VectorXd::Zero(weight_.size());
  if (slope) slope->setZero(weight_.size(), static_cast<Eigen::Index>(D.size()) + 1);
  for (Eigen::Index p = 0; p < K.size(); ++p) {
    const double r = std::min(length_[p] / horizon_, 1.0), power = std::pow(r, -alpha);
    for (size_t k = 0; k < D.size(); ++k) {
      const double one = power * bernstein(k, D.size() - 1, r);
      K[p] += D[k] * one;
      if (slope) (*slope)(p, static_cast<Eigen::Index>(k) + 1) = one;
    }
    if (slope) (*slope)(p, 0) = -std::log(r) * K[p];
  }
  return K;
}

double WaveOperator::weighted(const Eigen::VectorXd& K) const {
  return (K.array() * weight_.array() * length_.array().square()).sum();
}

Eigen::VectorXd WaveOperator::kappa(const Eigen::VectorXd& K) const {
  return K.cwiseProduct(weight_) / weighted(K);
}

Eigen::VectorXd WaveOperator::by_kernel(const Eigen::VectorXd& kappa, const Eigen::VectorXd& K,
                                        const Eigen::VectorXd& by_kappa) const {
  const double m = weighted(K), along = by_kappa.dot(kappa);
  return weight_.cwiseProduct(by_kappa - along * length_.cwiseAbs2()) / m;
}

WaveOperator::Parts WaveOperator::parts(const Eigen::VectorXd& kappa) const {
  Parts out{Eigen::Matrix2Xd::Zero(2, sine_.cols()), {}};
  Eigen::Matrix2Xd along(2, kappa.size());
  Eigen::Matrix3Xd outer(3, kappa.size());
  for (Eigen::Index p = 0; p < kappa.size(); ++p) {
    const Eigen::Vector2d& r = offset_[static_cast<size_t>(p)];
    along.col(p) = kappa[p] * r;
    outer.col(p) =
        kappa[p] / (length_[p] * length_[p]) * Eigen::Vector3d(r[0] * r[0], r[0] * r[1], r[1] * r[1]);
  }
  out.s = along * sine_;
  const Eigen::Matrix3Xd g = outer * one_less_cosine_;
  for (Eigen::Index k = 0; k < g.cols(); ++k)
    out.G.push_back((Eigen::Matrix2d() << g(0, k), g(1, k), g(1, k), g(2, k)).finished());
  return out;
}

Eigen::VectorXd WaveOperator::back(const Parts& slopes) const {
  const Eigen::MatrixXd by_s = sine_ * slopes.s.transpose();  // [offset, axis]
  Eigen::Matrix3Xd g(3, sine_.cols());
  for (Eigen::Index k = 0; k < g.cols(); ++k) {
    const Eigen::Matrix2d& m = slopes.G[static_cast<size_t>(k)];
    g.col(k) << m(0, 0), m(0, 1) + m(1, 0), m(1, 1);
  }
  const Eigen::MatrixXd by_g = one_less_cosine_ * g.transpose();
  Eigen::VectorXd out(weight_.size());
  for (Eigen::Index p = 0; p < out.size(); ++p) {
    const Eigen::Vector2d& r = offset_[static_cast<size_t>(p)];
    out[p] = by_s(p, 0) * r[0] + by_s(p, 1) * r[1] +
             (by_g(p, 0) * r[0] * r[0] + by_g(p, 1) * r[0] * r[1] + by_g(p, 2) * r[1] * r[1]) /
                 (length_[p] * length_[p]);
  }
  return out;
}

Eigen::Matrix2d WaveOperator::matrix(double lambda, double mu, const Parts& parts, size_t wave) {
  const Eigen::Vector2d s = parts.s.col(static_cast<Eigen::Index>(wave));
  return 4 * (lambda - mu) * s * s.transpose() + 16 * mu * parts.G[wave];
}

// With r^2 to second order in k: 16 mu sum kappa x^4/(2 r^2) and so on; sum kappa x^2 is 1/2.
std::array<double, 3> WaveOperator::long_waves(const Kernel& kernel) const {
  const Eigen::VectorXd share = kappa(kernel_at(kernel.alpha, kernel.D));
  double xx = 0, x4 = 0, mixed = 0;
  for (Eigen::Index p = 0; p < share.size(); ++p) {
    const Eigen::Vector2d r = offset_[static_cast<size_t>(p)];
    const double r2 = r.squaredNorm();
    xx += share[p] * r[0] * r[0];
    x4 += share[p] * std::pow(r[0], 4) / r2;
    mixed += share[p] * r[0] * r[0] * r[1] * r[1] / r2;
  }
  const double dilatation = 4 * (kernel.lambda - kernel.mu) * xx * xx;
  const double c11 = dilatation + 8 * kernel.mu * x4, c66 = 8 * kernel.mu * mixed;
  return {c11, c66, (c11 - (dilatation + c66)) / 2};
}

std::array<double, 2> WaveOperator::anisotropy(const Eigen::VectorXd& kappa,
                                               std::array<Eigen::VectorXd, 2>* by_kappa) const {
  std::array<Eigen::VectorXd, 2> share{Eigen::VectorXd(kappa.size()), Eigen::VectorXd(kappa.size())};
  for (Eigen::Index p = 0; p < kappa.size(); ++p) {
    const Eigen::Vector2d square = offset_[static_cast<size_t>(p)].cwiseAbs2();
    share[0][p] = 8 * square[0] * square[1] / square.sum();
    share[1][p] = 2 * std::pow(square[0] - square[1], 2) / square.sum();
  }
  if (by_kappa) *by_kappa = share;
  return {share[0].dot(kappa) - 1, share[1].dot(kappa) - 1};
}

std::vector<Eigen::Vector2cd> WaveOperator::waves_of(const std::vector<Vec3>& field) const {
  std::vector<Eigen::Vector2cd> out(wave_.size(), Eigen::Vector2cd::Zero());
  for (size_t p = 0; p < field.size(); ++p) {
    const Vec3 at = grid_.at(p);
    const Eigen::Vector2d x = eigen(at).head<2>(), f = eigen(field[p]).head<2>();
    for (size_t k = 0; k < wave_.size(); ++k) out[k] += std::polar(1.0, -wave_[k].dot(x)) * f;
  }
  return out;
}

}  // namespace cuboct::learn
