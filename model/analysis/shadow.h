// SPDX-License-Identifier: MIT
// Whether the shadow that a body throws along an axis falls wholly on another body.
#pragma once

#include <optional>
#include <vector>

#include "model/base/vec.h"

namespace cuboct {

struct Gap {
  double least = 0, most = 0;  // m, over the columns of the body along the axis, between centres of particles
};

// Of particles `ids` of `x` in front of those of `wall`, downwards (side 0) or upwards along the axis. They
// are shifted across the axis by all parts of `drift`, m. A column is covered where some particle of the wall
// lies ahead within `spacing` of it, m: nothing of that size passes between. None: some column is not
// covered, or there are too many places to look at.
std::optional<Gap> gap_to(const std::vector<Vec3>& x, const std::vector<uint32_t>& ids,
                          const std::vector<uint32_t>& wall, int axis, int side, Vec3 drift, double spacing);

}  // namespace cuboct
