// SPDX-License-Identifier: MIT
#include "study/potential_fit/granular_search.h"

#include <algorithm>
#include <random>

namespace cuboct::bond_fit {
namespace {

constexpr double kCoarsest = 1.0 / 8, kFinest = 0x1p-26;

Point beside(const Point& best, double grain, std::mt19937_64& random) {
  Point out = best;
  for (double& x : out) {
    const double move = static_cast<double>(random() % 3) - 1;
    x = std::clamp(x + move * grain, 0.0, 1.0);
  }
  return out;
}

}  // namespace

void granular_search(const std::function<double(const Point&)>& squared, Point best, int evaluations,
                     uint64_t seed) {
  std::mt19937_64 random(seed);
  double least = squared(best), grain = kCoarsest;
  int done = 1;
  while (grain >= kFinest && done < evaluations) {
    bool better = false;
    for (size_t look = 0; look < 2 * best.size() && done < evaluations; ++look, ++done) {
      Point point = beside(best, grain, random);
      const double here = squared(point);
      if (here < least) least = here, best = std::move(point), better = true;
    }
    grain = better ? std::min(2 * grain, kCoarsest) : grain / 2;
  }
}

}  // namespace cuboct::bond_fit
