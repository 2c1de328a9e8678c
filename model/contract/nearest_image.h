// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "model/contract/rule.h"

namespace cuboct {

// `d` in the nearest image: each periodic axis in [-extent/2, extent/2]. m
inline Vec3 nearest_image(Vec3 d, const Periodic& periodic) {
  constexpr double kSurely = 0.49;  // of a period: below it the rounded quotient is 0, and most pairs are
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = periodic.extent[axis];
    if (extent > 0 && std::abs(d[axis]) > kSurely * extent) d[axis] -= extent * std::round(d[axis] / extent);
  }
  return d;
}

}  // namespace cuboct
