// SPDX-License-Identifier: MIT
// How often a run reads its probes where the scene leaves it to cuboct.
#pragma once

#include <algorithm>
#include <cstdint>

namespace cuboct {

// Steps from one reading to the next. 500 readings draw any curve. One costs as much as one to seven steps
// (cli/estimate.cpp has what was measured), so those of a short run stand 20 steps apart. They take up to a
// fifth of its time, a quarter in a gas. 64 it has in any case.
inline constexpr uint64_t kMostReadings = 500;
inline uint64_t usual_probe_every(uint64_t steps) {
  constexpr uint64_t kApart = 20, kFewest = 64;
  return std::max({uint64_t{1}, steps / kMostReadings, std::min(kApart, steps / kFewest)});
}

}  // namespace cuboct
