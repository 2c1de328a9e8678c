// SPDX-License-Identifier: MIT
// Phase two of the learning: the critical stretch of a solid whose kernel is known, from atoms that crack.
#pragma once

#include "study/learn/prediction.h"

namespace cuboct::learn {

// A critical stretch that was tried.
struct StretchPoint {
  double stretch = 0;
  CrackErrors errors;   // of the training's frames, predicted from the first
  double residual = 0;  // of equation 42, relative
};
struct StretchFit {
  double stretch = 0;               // whose predicted displacements are off the least
  std::vector<StretchPoint> tried;  // in ascending order
};

// A scan between the bounds, then bisection on both sides of its best. The paper takes the least residual of
// equation 42; docs/measured/learn.md shows why this takes the least error of predicted displacements.
// Throws study::Interrupted.
StretchFit fit_stretch(const CrackData& data, const Kernel& kernel, double slit, double interval,
                       const StretchInput& input, const PredictionInput& prediction);

}  // namespace cuboct::learn
