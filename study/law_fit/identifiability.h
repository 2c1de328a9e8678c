// SPDX-License-Identifier: MIT
// Which parameters a curve tells apart: the singular values of its sensitivity.
#pragma once

#include <vector>

#include "study/law_fit/drawn_law.h"

namespace cuboct::fit {

// By how much a curve moves with one parameter, on even strains, per width of the parameter's bounds.
using Slopes = std::vector<double>;

struct Combination {
  double change = 0;            // of the curve, over the target, for a move by one width of bounds
  std::vector<double> weights;  // of the parameters: a unit vector, its largest component positive
};
struct Identifiability {
  std::vector<Combination> combinations;  // from what moves the curve most to what moves it least
  // Of each parameter: how far it may be off, in widths of its bounds, while the curve stays within `error`;
  // no combination is off by more than 1.
  std::vector<double> uncertainty;
};

// From here on the data say nothing of a parameter.
inline constexpr double kUnknown = 0.5;

// `error`: of the curve, over the target: what counts as no difference.
Identifiability identifiability(const std::vector<Slopes>& slopes, const std::vector<double>& target,
                                double error);

}  // namespace cuboct::fit
