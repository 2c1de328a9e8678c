// SPDX-License-Identifier: MIT
// What packings of one crystal and of many grains share.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <utility>

#include "model/body/packing.h"

namespace cuboct {

inline constexpr double kSiteTolerance = 1e-6;  // of the pitch: sites so near to a surface lie on it

// The h at which start + h * step lies within the bounds grown by `slack`; first > second where it never
// does. In a crystal that is turned against a thin body, most rows of the bounds' corners' range pass it by.
std::pair<double, double> inside_bounds(const Vec3& start, const Vec3& step, const Bounds& bounds,
                                        double slack);

// m, of what is packed: the shape's, cut by the box. InputError where it has no end.
Bounds packing_bounds(const Shape* shape, const Periodic& box);

// The range of (h, k, l), in half cells of the crystal, that the corners of `bounds` span.
Bounds indices_in(const Fcc& fcc, const Bounds& bounds);

// The first and the last (h, k, l) of those, one more on each side.
struct SiteIndices {
  std::array<int64_t, 3> first, last;
};
SiteIndices site_indices(const Fcc& fcc, const Bounds& bounds);

// In (0, 1), 53 bits; never 0, of which no logarithm exists.
inline double uniform(std::mt19937_64& generator) {
  return (static_cast<double>(generator() >> 11) + 0.5) * 0x1p-53;
}

}  // namespace cuboct
