// SPDX-License-Identifier: MIT
// The operator of the linear peridynamic solid on points in rows that repeat, as a matrix of two rows for
// each wave: on waves it is diagonal, so that a fit needs no sum over points. With the weights W of equation
// 19,
//   kappa_p = K(r_p) W_p / sum K W r^2,  s = sum kappa r sin k.r,  G = sum kappa r r^T/r^2 (1 - cos k.r),
//   S = 4 (lambda - mu) s s^T + 16 mu G,  S u = b  (equation 17 for u = exp(i k.x))
// What makes the problem solvable (equation 37): G has positive eigenvalues, s G^-1 s is positive where s is
// not 0, and 16 G - 8 s s^T has no negative eigenvalue, so that with lambda + mu > 0 and mu > 0 none of S is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "study/learn/samples.h"

namespace cuboct::learn {

// What is learned in phase one. K(r) = (horizon/r)^alpha sum D_k B_k,P(r/horizon).
struct Kernel {
  double lambda = 0, mu = 0;  // Pa, of plane stress
  double alpha = 0;
  std::vector<double> D;
  double horizon = 0;  // over the spacing
};

class WaveOperator {
 public:
  // InputError where the horizon has too few points for the weights.
  WaveOperator(const Grid& grid, double horizon);

  size_t points() const { return offset_.size(); }  // within the horizon
  size_t waves() const { return wave_.size(); }     // all but that of k = 0
  const Eigen::Vector2d& wave(size_t k) const { return wave_[k]; }
  // Whether s is 0 by symmetry.
  bool even(size_t k) const { return even_[k]; }
  // Of k^2 on the points: sum over axes of (2 - 2 cos k h)/h^2.
  double square(size_t k) const { return square_[k]; }

  // Equation 35 at the offsets, and its slope by (alpha, D_0, D_1 ...).
  Eigen::VectorXd kernel_at(double alpha, const std::vector<double>& D,
                            Eigen::MatrixXd* slope = nullptr) const;
  // kappa, and d/dK of a function whose slope by kappa is known.
  Eigen::VectorXd kappa(const Eigen::VectorXd& K) const;
  Eigen::VectorXd by_kernel(const Eigen::VectorXd& kappa, const Eigen::VectorXd& K,
                            const Eigen::VectorXd& by_kappa) const;
  double weighted(const Eigen::VectorXd& K) const;  // sum K W r^2, m^4
  Eigen::VectorXd by_weighted() const { return weight_.cwiseProduct(length_.cwiseAbs2()); }  // its slope by K

  struct Parts {
    Eigen::Matrix2Xd s;              // [wave], 1/m
    std::vector<Eigen::Matrix2d> G;  // [wave], 1/m^2
  };
  Parts parts(const Eigen::VectorXd& kappa) const;
  // The slope by kappa of a function with these slopes by s and G.
  Eigen::VectorXd back(const Parts& slopes) const;
  static Eigen::Matrix2d matrix(double lambda, double mu, const Parts& parts, size_t wave);

  // Constants of long waves along x: C11 and C66, and (C11 - C12)/2 of those on the diagonal. Pa. An
  // isotropic solid has lambda + 2 mu, mu and mu.
  std::array<double, 3> long_waves(const Kernel& kernel) const;
  // C66 and (C11 - C12)/2 over mu, less 1: 0 where long waves are those of an isotropic solid. With slopes.
  std::array<double, 2> anisotropy(const Eigen::VectorXd& kappa,
                                   std::array<Eigen::VectorXd, 2>* by_kappa) const;
  // Of the field on all points its waves, in the order of wave(): sums over points times exp(-i k.x).
  std::vector<Eigen::Vector2cd> waves_of(const std::vector<Vec3>& field) const;

 private:
  Grid grid_;
  double horizon_;  // m
  std::vector<Eigen::Vector2d> offset_, wave_;
  Eigen::VectorXd weight_, length_;         // [offset]
  Eigen::MatrixXd sine_, one_less_cosine_;  // [offset, wave]
  std::vector<double> square_;
  std::vector<char> even_;
};

}  // namespace cuboct::learn
