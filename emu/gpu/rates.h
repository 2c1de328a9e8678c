// SPDX-License-Identifier: MIT
// How fast the gpu engine steps, without all that comes before its first step.
#pragma once

#include <vector>

#include "emu/gpu/engine.h"

namespace cuboct::gpu {

struct RateRequest {
  Arithmetic arithmetic = Arithmetic::fixed;
  uint64_t steps = 0;  // of one run, at least 1
  int repeats = 3;
  double seconds = 0.3;  // of stepping that each repeat takes at least
  Options engine;
  bool interpret = false;  // as GpuChoice
};

// Steps per second of each repeat: of whole runs from the scene's start, as many as it takes. One repeat more
// goes first, untold: kernels are loaded then and clocks rise. Fewer where model/base/interrupt.h ends them.
// Throws RunError where a run stops.
std::vector<double> step_rates(const Scene& scene, const Plan& plan, const RateRequest& request);

}  // namespace cuboct::gpu
