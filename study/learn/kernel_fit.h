// SPDX-License-Identifier: MIT
// Phase one of the learning: kernel and moduli from sheets that are whole (equations 37 to 40 of the paper),
// by an augmented Lagrangian (M. J. D. Powell; R. T. Rockafellar, 1973) around NLopt's L-BFGS.
#pragma once

#include "study/learn/wave_operator.h"

namespace cuboct::learn {

// Mean over samples of |S u - b|^2/|b|^2 as sums over waves, whatever the number of samples.
class KernelLoss {
 public:
  // `weight`: of each sample. InputError where one has no load, or a number that is not finite.
  KernelLoss(const WaveOperator& symbol, const std::vector<const StaticSample*>& samples,
             const std::vector<double>& weight);
  // Adds its slopes to `slopes` and to those by lambda and mu, in 1/TPa, where they are given.
  double at(double lambda, double mu, const WaveOperator::Parts& parts, WaveOperator::Parts* slopes = nullptr,
            double* by_lambda = nullptr, double* by_mu = nullptr) const;

 private:
  std::vector<Eigen::Matrix2d> uu_, ub_;  // [wave], scaled
  double bb_ = 0;
};

// The unknowns of the search: (lambda + mu, mu) in TPa, alpha, D.
using Unknowns = std::vector<double>;
Kernel kernel_of(const Unknowns& unknowns, double horizon);

class KernelProblem {
 public:
  KernelProblem(const WaveOperator& symbol, const KernelLoss& loss, const KernelInput& input);

  // Loss and regularisation, with its slope; the multipliers' terms where `multipliers` is given.
  double at(const Unknowns& unknowns, double* slope) const;
  // Of equation 37, each at least 0 where it holds.
  std::vector<double> constraints(const Unknowns& unknowns) const;

  std::vector<double> multiplier;  // of each constraint
  double penalty = 0;              // 0: without constraints

 private:
  double regularisation(const Unknowns& unknowns, double weighted, double* by_weighted, double* slope) const;
  struct Slopes;
  std::vector<double> constraints(const WaveOperator::Parts& parts, Slopes* slopes) const;

  const WaveOperator& symbol_;
  const KernelLoss& loss_;
  const KernelInput& input_;
  double scale_;  // m^4, of sum K W r^2 for K = 1
};

struct CurvePoint {
  int evaluations = 0;
  double training = 0, validation = 0;  // relative residuals: roots of the losses
};
struct KernelFit {
  Kernel kernel;
  double training = 0, validation = 0;
  double constraint = 0;  // the least; not far below 0
  int evaluations = 0;
  std::vector<CurvePoint> curve;
};
// What is looked for.
struct KernelSearch {
  double horizon = 0;  // over the spacing
  int degree = 0;
  // Samples are drawn anew, with replacement, by this seed; 0: each once. It also turns the start.
  uint64_t draw = 0;
  bool positive = false;         // no D_k below 0, and so no weight of a bond
  const Kernel* like = nullptr;  // has the moduli; null: they are learned too
  bool pairs = false;            // lambda = mu, where dilatation leaves no force: bonds are a pair law
};
KernelFit fit_kernel(const Grid& grid, const std::vector<StaticSample>& training,
                     const std::vector<StaticSample>& validation, const KernelInput& input,
                     const KernelSearch& search);

}  // namespace cuboct::learn
