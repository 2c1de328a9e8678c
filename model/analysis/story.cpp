// SPDX-License-Identifier: MIT
#include "model/analysis/story.h"

#include <algorithm>
#include <set>

namespace cuboct {
namespace {

// The first of the nearest.
size_t nearest(const std::vector<uint64_t>& steps, uint64_t step) {
  const auto distance = [step](uint64_t at) { return at > step ? at - step : step - at; };
  return static_cast<size_t>(std::ranges::min_element(steps, {}, distance) - steps.begin());
}

}  // namespace

std::vector<size_t> story_frames(const std::vector<uint64_t>& steps, const Curve* stress,
                                 std::optional<size_t> onset) {
  const size_t last = steps.size() - 1;
  std::set<size_t> chosen{0, last};
  if (onset) chosen.insert(*onset);
  if (stress) {
    const auto largest = std::ranges::max_element(stress->value) - stress->value.begin();
    const size_t peak = nearest(steps, stress->step[static_cast<size_t>(largest)]);
    chosen.insert(peak);
    chosen.insert(peak + (last - peak) / 4);
  }
  for (size_t k = 1; k <= 2; ++k)
    if (chosen.size() < 4) chosen.insert(k * last / 3);
  return {chosen.begin(), chosen.end()};
}

}  // namespace cuboct
