// SPDX-License-Identifier: MIT
#include "study/potential_fit/search.h"

#include <nlopt.h>

#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>

#include "study/potential_fit/granular_search.h"

namespace cuboct::bond_fit {
namespace {

constexpr double kStands = 1e-9;   // of L^2, between two steps
constexpr double kEnough = 1e-20;  // L^2 that no search needs to go below
constexpr double kSimplex = 0.1;   // of the bounds, Nelder and Mead's first step
constexpr int kMostDraws = 1000;

// The loss, and the best point of all that were asked for.
class Watched {
 public:
  Watched(const Problem& problem, Descent* descent) : problem_(problem), descent_(descent) {}

  double at(const Point& point, double* gradient) {
    const double square = squared_loss(problem_, point, gradient);
    ++best_.evaluations;
    if (best_.point.empty() || square < least_) take(point, square);
    return square;
  }
  const Found& best() const { return best_; }

  static double call(unsigned size, const double* x, double* gradient, void* self) {
    return static_cast<Watched*>(self)->at(Point(x, x + size), gradient);
  }

 private:
  void take(const Point& point, double square) {
    least_ = square;
    best_.point = point;
    best_.loss = std::sqrt(square);
    if (!descent_) return;
    descent_->evaluation.push_back(best_.evaluations);
    descent_->loss.push_back(best_.loss);
  }

  const Problem& problem_;
  Descent* descent_;
  Found best_;
  double least_ = 0;
};

struct Closed {
  void operator()(nlopt_opt search) const { nlopt_destroy(search); }
};

// NLopt ends with a negative code where rounding leaves nothing to gain or a line search finds nothing lower:
// the best point of all stands then.
void by_nlopt(Watched& watched, nlopt_algorithm algorithm, Point start, int evaluations) {
  const std::unique_ptr<nlopt_opt_s, Closed> search(nlopt_create(algorithm, kTersoffFree));
  nlopt_set_lower_bounds1(search.get(), 0);
  nlopt_set_upper_bounds1(search.get(), 1);
  nlopt_set_min_objective(search.get(), &Watched::call, &watched);
  nlopt_set_maxeval(search.get(), evaluations);
  nlopt_set_ftol_rel(search.get(), kStands);
  nlopt_set_stopval(search.get(), kEnough);
  if (algorithm == NLOPT_LN_NELDERMEAD) nlopt_set_initial_step1(search.get(), kSimplex);
  double least = 0;
  if (nlopt_optimize(search.get(), start.data(), &least) == NLOPT_INVALID_ARGS)
    throw std::logic_error("NLopt refuses what the search asks of it");
}

}  // namespace

std::string name_of(Method method) {
  switch (method) {
    case Method::lbfgs:
      return "L-BFGS";
    case Method::nelder_mead:
      return "Nelder-Mead";
    case Method::granular:
      return "granular search";
  }
  return "";
}

Found descend(const Problem& problem, Method method, const Point& start, int evaluations, uint64_t seed,
              Descent* descent) {
  Watched watched(problem, descent);
  switch (method) {
    case Method::lbfgs:
      by_nlopt(watched, NLOPT_LD_LBFGS, start, evaluations);
      break;
    case Method::nelder_mead:
      by_nlopt(watched, NLOPT_LN_NELDERMEAD, start, evaluations);
      break;
    case Method::granular:
      granular_search([&](const Point& point) { return watched.at(point, nullptr); }, start, evaluations,
                      seed);
      break;
  }
  return watched.best();
}

Point random_start(const Problem& problem, uint64_t seed, uint64_t index) {
  std::seed_seq both{seed, seed >> 32, index, index >> 32};
  std::mt19937_64 random(both);
  Point point(kTersoffFree);
  for (int draw = 0; draw < kMostDraws; ++draw) {
    for (double& x : point) x = static_cast<double>(random() >> 11) * 0x1p-53;
    if (loss_of(problem, parameters_at(problem, point)) < kNoLattice) return point;
  }
  throw std::runtime_error("no parameters between the bounds hold a lattice together");
}

}  // namespace cuboct::bond_fit
