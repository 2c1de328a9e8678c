// SPDX-License-Identifier: MIT
// How often a run reads energies where the scene leaves it to cuboct.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace cuboct {

struct Scene;

// Steps between two readings.
struct Readings {
  uint64_t probes = 0;    // 0: never
  uint64_t energies = 0;  // a multiple of `probes`; 0: first and last only
};

// Of a run of `steps`, which need not be the scene's: the scene's intervals. Where these make more than a
// million readings, what the file leaves to cuboct follows the steps that are run.
Readings readings_of(const Scene& scene, uint64_t steps);

// Whether [run] of the scene's file, or its stage, has `key`.
bool gives(const Scene& scene, const std::string& key);

// The least multiple of `of` that is not below `steps`; 0 of 0.
inline uint64_t whole_multiple(uint64_t steps, uint64_t of) {
  return steps == 0 ? 0 : (steps - 1) / of * of + of;
}

// Energies take all particles and all pairs: one reading costs as much as one to seven steps
// (cli/run/estimate.cpp has what was measured). 200 steps apart they take half to three and a half per cent
// of a run, and all readings together a tenth at most. A short run has 20 all the same. `probe_every` > 0:
// energies are read with probes, at whole multiples of it.
inline uint64_t usual_energy_every(uint64_t steps, uint64_t probe_every) {
  constexpr uint64_t kApart = 200, kFewest = 20;
  const uint64_t least = std::clamp<uint64_t>(steps / kFewest, 1, kApart);
  return whole_multiple(least, probe_every);
}

}  // namespace cuboct
