// SPDX-License-Identifier: MIT
#include "study/potential_fit/loss.h"

#include <algorithm>
#include <cmath>

namespace cuboct::bond_fit {
namespace {

struct Scaled {
  double value, slope;  // the parameter and its derivative by the place
};

Scaled scaled(const Bounds& b, double place) {
  if (b.high == b.low) return {b.low, 0};
  if (!b.logarithm) return {b.low + place * (b.high - b.low), b.high - b.low};
  const double span = std::log(b.high / b.low), value = b.low * std::exp(place * span);
  return {value, value * span};
}

// How far a property is off: relative, but where it should be 0.
double scale_of(const Goal& goal, size_t p) { return p == edge_slope ? 1 : goal.value[p]; }

double mean_square(const Goal& goal, const DiamondProperties& is) {
  double sum = 0, weights = 0;
  for (size_t p = 0; p < kDiamondProperties; ++p) {
    const double off = (is.value[p] - goal.value[p]) / scale_of(goal, p);
    sum += goal.weight[p] * off * off;
    weights += goal.weight[p];
  }
  return sum / weights;
}

bool counts(const DiamondProperties& is, double square) {
  return is.inner > 0 && square < kNoLattice * kNoLattice;
}

}  // namespace

TersoffFree parameters_at(const Problem& problem, const Point& point) {
  TersoffFree out;
  for (size_t k = 0; k < kTersoffFree; ++k) out[k] = scaled(problem.bounds[k], point[k]).value;
  return out;
}

Point point_of(const Problem& problem, const TersoffFree& parameters) {
  Point out(kTersoffFree, 0.5);
  for (size_t k = 0; k < kTersoffFree; ++k) {
    const Bounds& b = problem.bounds[k];
    if (b.high == b.low) continue;
    const double value = std::clamp(parameters[k], b.low, b.high);
    out[k] =
        b.logarithm ? std::log(value / b.low) / std::log(b.high / b.low) : (value - b.low) / (b.high - b.low);
  }
  return out;
}

double loss_of(const Problem& problem, const TersoffFree& parameters) {
  const DiamondProperties is =
      diamond_properties(with_free(problem.fixed, parameters), problem.goal.edge, false);
  const double square = mean_square(problem.goal, is);
  return counts(is, square) ? std::sqrt(square) : kNoLattice;
}

double squared_loss(const Problem& problem, const Point& point, double* gradient) {
  const Goal& goal = problem.goal;
  const DiamondProperties is = diamond_properties(with_free(problem.fixed, parameters_at(problem, point)),
                                                  goal.edge, gradient != nullptr);
  const double square = mean_square(goal, is);
  const bool real = counts(is, square);
  if (!gradient) return real ? square : kNoLattice * kNoLattice;
  std::fill_n(gradient, kTersoffFree, 0.0);
  if (!real) return kNoLattice * kNoLattice;
  double weights = 0;
  for (const double w : goal.weight) weights += w;
  for (size_t p = 0; p < kDiamondProperties; ++p) {
    const double scale = scale_of(goal, p);
    const double pull = 2 * goal.weight[p] * (is.value[p] - goal.value[p]) / (scale * scale) / weights;
    for (size_t k = 0; k < kTersoffFree; ++k)
      gradient[k] += pull * is.slopes[p][k] * scaled(problem.bounds[k], point[k]).slope;
  }
  return square;
}

}  // namespace cuboct::bond_fit
