// SPDX-License-Identifier: MIT
#include "study/learn/kernel_fit.h"

#include <fmt/format.h>
#include <nlopt.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "model/base/dense.h"
#include "model/base/error.h"

namespace cuboct::learn {
namespace {

constexpr double kTera = 1e12;
constexpr double kMostAlpha = 2.95;  // alpha < 3
constexpr double kLeast = 1e-3;      // TPa, of lambda + mu and mu
constexpr int kOuter = 12;           // turns of the multipliers
constexpr double kHolds = 1e-6;      // a constraint that is no farther below 0 holds

constexpr double kLong = 0.5;  // power of a sample's wavelength, squared, that it counts with

double plain(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) { return a.cwiseProduct(b).sum(); }

}  // namespace

KernelLoss::KernelLoss(const WaveOperator& symbol, const std::vector<const StaticSample*>& samples,
                       const std::vector<double>& weight)
    : uu_(symbol.waves(), Eigen::Matrix2d::Zero()), ub_(uu_) {
  std::vector<double> load(samples.size()), length(samples.size());
  double sum = 0;
  for (size_t n = 0; n < samples.size(); ++n) {
    double moved = 0;
    for (const Vec3& one : samples[n]->b) load[n] += one.squaredNorm();
    for (const Vec3& one : samples[n]->u) moved += one.squaredNorm();
    if (!(load[n] > 0) || !std::isfinite(load[n]) || !(moved > 0) || !std::isfinite(moved))
      throw InputError(fmt::format("sample {} has no load, or a number that is not finite", n));
    length[n] = weight[n] * std::pow(moved / load[n], kLong);
    sum += length[n];
  }
  for (size_t n = 0; n < samples.size(); ++n) {
    const auto u = symbol.waves_of(samples[n]->u), b = symbol.waves_of(samples[n]->b);
    const double share = length[n] / (sum * load[n] * static_cast<double>(samples[n]->b.size()));
    for (size_t k = 0; k < u.size(); ++k) {
      uu_[k] += share * kTera * kTera * (u[k] * u[k].adjoint()).real();
      ub_[k] += share * kTera * (u[k] * b[k].adjoint()).real();
      bb_ += share * b[k].squaredNorm();
    }
  }
}

// tr(S uu S) - 2 tr(S ub) + bb, of which S uu + uu S - ub - ub^T is the slope by S.
double KernelLoss::at(double lambda, double mu, const WaveOperator::Parts& parts, WaveOperator::Parts* slopes,
                      double* by_lambda, double* by_mu) const {
  double sum = bb_;
  for (size_t k = 0; k < uu_.size(); ++k) {
    const Eigen::Matrix2d S = WaveOperator::matrix(lambda, mu, parts, k), Su = S * uu_[k];
    sum += plain(Su, S) - 2 * plain(S, ub_[k]);
    if (!slopes) continue;
    const Eigen::Matrix2d by = Su + Su.transpose() - ub_[k] - ub_[k].transpose();
    const auto column = static_cast<Eigen::Index>(k);
    const Eigen::Vector2d s = parts.s.col(column);
    slopes->G[k] += 16 * mu * by;
    slopes->s.col(column) += 8 * (lambda - mu) * by * s;
    const double dilatation = 4 * s.dot(by * s);
    *by_lambda += dilatation, *by_mu += 16 * plain(by, parts.G[k]) - dilatation;
  }
  return sum;
}

Kernel kernel_of(const Unknowns& x, double horizon) {
  return {(x[0] - x[1]) * kTera, x[1] * kTera, x[2], {x.begin() + 3, x.end()}, horizon};
}

KernelProblem::KernelProblem(const WaveOperator& symbol, const KernelLoss& loss, const KernelInput& input)
    : symbol_(symbol),
      loss_(loss),
      input_(input),
      scale_(symbol.weighted(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(symbol.points())))) {}

// The slopes of all constraints, each times its own factor.
struct KernelProblem::Slopes {
  const std::vector<double>* factor;
  WaveOperator::Parts* parts;
};

std::vector<double> KernelProblem::constraints(const WaveOperator::Parts& parts, Slopes* slopes) const {
  std::vector<double> out;
  for (size_t k = 0; k < symbol_.waves(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Eigen::Vector2d s = parts.s.col(column);
    const Eigen::Matrix2d& G = parts.G[k];
    const double square = symbol_.square(k);
    const auto factor = [&] { return (*slopes->factor)[out.size() - 1]; };
    const auto deviatoric = eigensystem<Eigen::Matrix2d>(16 * G);
    out.push_back(deviatoric.values[0] / square - input_.zeta);
    if (slopes) {
      const Eigen::Vector2d v = deviatoric.vectors.col(0);
      slopes->parts->G[k] += factor() * 16 / square * v * v.transpose();
    }
    const auto rest = eigensystem<Eigen::Matrix2d>(16 * G - 8 * s * s.transpose());
    out.push_back(rest.values[0] / square);
    if (slopes) {
      const Eigen::Vector2d v = rest.vectors.col(0);
      slopes->parts->G[k] += factor() * 16 / square * v * v.transpose();
      slopes->parts->s.col(column) -= factor() * 16 / square * v.dot(s) * v;
    }
    if (symbol_.even(k)) continue;
    const Eigen::Vector2d inverse = G.inverse() * s;
    out.push_back(s.dot(inverse) / 4 - input_.zeta);
    if (slopes) {
      slopes->parts->s.col(column) += factor() / 2 * inverse;
      slopes->parts->G[k] -= factor() / 4 * inverse * inverse.transpose();
    }
  }
  return out;
}

std::vector<double> KernelProblem::constraints(const Unknowns& x) const {
  const Kernel kernel = kernel_of(x, 0);
  return constraints(symbol_.parts(symbol_.kappa(symbol_.kernel_at(kernel.alpha, kernel.D))), nullptr);
}

// The kernel's size says nothing: it is held at 1. Neighbouring coefficients are held together a little, so
// that what the samples do not tell stays smooth.
double KernelProblem::regularisation(const Unknowns& x, double weighted, double* by_weighted,
                                     double* slope) const {
  const double off = weighted / scale_ - 1;
  *by_weighted = 2 * off / scale_;
  double sum = off * off;
  for (size_t k = 3; k + 1 < x.size(); ++k) {
    const double step = x[k + 1] - x[k];
    sum += input_.smoothing * step * step;
    if (slope) slope[k + 1] += 2 * input_.smoothing * step, slope[k] -= 2 * input_.smoothing * step;
  }
  return sum;
}

double KernelProblem::at(const Unknowns& x, double* slope) const {
  const Kernel kernel = kernel_of(x, 0);
  const double lambda = kernel.lambda / kTera, mu = kernel.mu / kTera;
  Eigen::MatrixXd by_unknowns;
  const Eigen::VectorXd K = symbol_.kernel_at(kernel.alpha, kernel.D, slope ? &by_unknowns : nullptr);
  const Eigen::VectorXd kappa = symbol_.kappa(K);
  const WaveOperator::Parts parts = symbol_.parts(kappa);
  if (slope) std::fill(slope, slope + x.size(), 0.0);
  WaveOperator::Parts slopes{Eigen::Matrix2Xd::Zero(2, parts.s.cols()),
                             std::vector<Eigen::Matrix2d>(parts.G.size(), Eigen::Matrix2d::Zero())};
  double by_lambda = 0, by_mu = 0, by_weighted = 0;
  double sum = loss_.at(lambda, mu, parts, slope ? &slopes : nullptr, &by_lambda, &by_mu);
  if (penalty > 0) {
    const std::vector<double> c = constraints(parts, nullptr);
    std::vector<double> factor(c.size());
    for (size_t i = 0; i < c.size(); ++i) {
      const double active = std::max(0.0, multiplier[i] - penalty * c[i]);
      sum += (active * active - multiplier[i] * multiplier[i]) / (2 * penalty);
      factor[i] = -active;
    }
    Slopes of{&factor, &slopes};
    if (slope) constraints(parts, &of);
  }
  sum += regularisation(x, symbol_.weighted(K), &by_weighted, slope);
  std::array<Eigen::VectorXd, 2> by_kappa;
  const std::array<double, 2> uneven = symbol_.anisotropy(kappa, slope ? &by_kappa : nullptr);
  for (const double one : uneven) sum += input_.isotropy * one * one;
  if (!slope) return sum;
  slope[0] += by_lambda;
  slope[1] += by_mu - by_lambda;
  Eigen::VectorXd by_K = symbol_.by_kernel(
      kappa, K,
      symbol_.back(slopes) + 2 * input_.isotropy * (uneven[0] * by_kappa[0] + uneven[1] * by_kappa[1]));
  by_K += by_weighted * symbol_.by_weighted();
  const Eigen::VectorXd rest = by_unknowns.transpose() * by_K;
  for (Eigen::Index k = 0; k < rest.size(); ++k) slope[2 + k] += rest[k];
  return sum;
}

namespace {

struct Closed {
  void operator()(nlopt_opt search) const { nlopt_destroy(search); }
};

struct Watched {
  const KernelProblem& problem;
  bool pairs = false;
  int evaluations = 0;
  static double call(unsigned size, const double* x, double* slope, void* self) {
    auto& watched = *static_cast<Watched*>(self);
    ++watched.evaluations;
    Unknowns at(x, x + size);
    if (watched.pairs) at[0] = 2 * at[1];
    const double value = watched.problem.at(at, slope);
    if (watched.pairs && slope) slope[1] += 2 * slope[0], slope[0] = 0;
    return value;
  }
};

// NLopt ends with a negative code where rounding leaves nothing to gain: x is then the best that it had.
int descend(const KernelProblem& problem, Unknowns& x, const KernelSearch& of, int most) {
  Watched watched{problem, of.pairs};
  const auto size = static_cast<unsigned>(x.size());
  const std::unique_ptr<nlopt_opt_s, Closed> search(nlopt_create(NLOPT_LD_LBFGS, size));
  Unknowns low(x.size(), -50), high(x.size(), 50);
  low[0] = low[1] = kLeast, high[0] = high[1] = 20;
  low[2] = 0, high[2] = kMostAlpha;
  if (of.positive) std::fill(low.begin() + 3, low.end(), 0.0);
  if (of.like) low[0] = high[0] = x[0], low[1] = high[1] = x[1];
  nlopt_set_lower_bounds(search.get(), low.data());
  nlopt_set_upper_bounds(search.get(), high.data());
  nlopt_set_min_objective(search.get(), &Watched::call, &watched);
  nlopt_set_maxeval(search.get(), most);
  nlopt_set_ftol_rel(search.get(), 1e-10);
  double least = 0;
  if (nlopt_optimize(search.get(), x.data(), &least) == NLOPT_INVALID_ARGS)
    throw std::logic_error("NLopt refuses what the search asks of it");
  if (of.pairs) x[0] = 2 * x[1];
  return watched.evaluations;
}

std::vector<double> drawn(size_t samples, uint64_t draw) {
  if (draw == 0) return std::vector<double>(samples, 1);
  std::vector<double> weight(samples);
  std::mt19937_64 random(draw);
  for (size_t k = 0; k < samples; ++k) weight[random() % samples] += 1;
  return weight;
}

std::vector<const StaticSample*> all_of(const std::vector<StaticSample>& samples) {
  std::vector<const StaticSample*> out;
  for (const StaticSample& sample : samples) out.push_back(&sample);
  return out;
}

// A cone of 1/r, and moduli of no material in particular.
Unknowns start(int degree, uint64_t draw) {
  std::mt19937_64 random(draw + 99);
  const auto part = [&] { return 0.8 + 0.4 * static_cast<double>(random() >> 11) * 0x1p-53; };
  Unknowns x{part(), part(), part()};
  for (int k = 0; k <= degree; ++k)
    x.push_back(part() * (degree == 0 ? 1 : 2 - 1.5 * static_cast<double>(k) / degree));
  return x;
}

}  // namespace

KernelFit fit_kernel(const Grid& grid, const std::vector<StaticSample>& training,
                     const std::vector<StaticSample>& validation, const KernelInput& input,
                     const KernelSearch& of) {
  const WaveOperator symbol(grid, of.horizon);
  const KernelLoss loss(symbol, all_of(training), drawn(training.size(), of.draw));
  const KernelLoss beside(symbol, all_of(validation), std::vector<double>(validation.size(), 1));
  KernelProblem problem(symbol, loss, input);
  Unknowns x = start(of.degree, of.draw);
  if (of.like) x[0] = (of.like->lambda + of.like->mu) / kTera, x[1] = of.like->mu / kTera;
  problem.multiplier.assign(problem.constraints(x).size(), 0);
  problem.penalty = 1;
  KernelFit out;
  const auto residual = [&](const KernelLoss& loss_of) {
    const Kernel k = kernel_of(x, of.horizon);
    const WaveOperator::Parts parts = symbol.parts(symbol.kappa(symbol.kernel_at(k.alpha, k.D)));
    return std::sqrt(std::max(0.0, loss_of.at(k.lambda / kTera, k.mu / kTera, parts)));
  };
  const auto look = [&] {
    out.training = residual(loss), out.validation = residual(beside);
    out.curve.push_back({out.evaluations, out.training, out.validation});
  };
  look();
  double before = -1;
  for (int turn = 0; turn < kOuter && out.evaluations < input.evaluations; ++turn) {
    // In pieces, so that the curve shows the way.
    for (int piece = 0; piece < 8 && out.evaluations < input.evaluations; ++piece) {
      const int done = descend(problem, x, of, std::max(4, input.evaluations / 40));
      out.evaluations += done;
      look();
      if (done < std::max(4, input.evaluations / 40)) break;
    }
    const std::vector<double> c = problem.constraints(x);
    out.constraint = *std::ranges::min_element(c);
    for (size_t i = 0; i < c.size(); ++i)
      problem.multiplier[i] = std::max(0.0, problem.multiplier[i] - problem.penalty * c[i]);
    if (out.constraint > -kHolds && turn > 1) break;
    if (out.constraint < before / 2) problem.penalty *= 4;
    before = std::min(0.0, out.constraint);
  }
  out.kernel = kernel_of(x, of.horizon);
  return out;
}

}  // namespace cuboct::learn
