// SPDX-License-Identifier: MIT
// What an operation of a graph can give where what it takes lies in intervals: whatever doubles make of it.
#pragma once

#include <cmath>
#include <optional>

#include "model/program/real_graph.h"

namespace cuboct {

// No number at all where both ends are none.
struct RealRange {
  double low = 0, high = 0;
  static RealRange whole() { return {-INFINITY, INFINITY}; }
  bool point() const { return low == high; }
};

// Holds applied() of all doubles of these intervals. Of points it is a point.
RealRange ranged(const RealNode& node, const RealRange& a, const RealRange& b, const RealRange& c);

// A truth that is the same all over its interval.
std::optional<bool> certain(const RealRange& truth);

}  // namespace cuboct
