// SPDX-License-Identifier: MIT
// Granular search, as D. Powell's thesis (Sheffield, 2006) is cited for it: random looks on a grid about the
// best point, whose grain becomes finer where it finds nothing. The thesis is not public; this is our
// reading.
#pragma once

#include <functional>

#include "study/potential_fit/loss.h"

namespace cuboct::bond_fit {

// `squared` of a point in [0, 1]^n. A round looks at 2 n points, each off the best one by -1, 0 or 1 grains
// along each axis. One that is better becomes the best, and the grain doubles, up to 1/8. A round without one
// halves it. Ends at a grain of 2^-26, or after `evaluations`.
void granular_search(const std::function<double(const Point&)>& squared, Point start, int evaluations,
                     uint64_t seed);

}  // namespace cuboct::bond_fit
