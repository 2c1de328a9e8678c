// SPDX-License-Identifier: MIT
// What the phase times of a trace amount to.
#pragma once

#include <optional>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct {

// Cycles that the machine takes per step: from the end of its slowest node in one step to that in the next.
struct CyclesPerStep {
  double mean = 0;
  uint64_t max = 0;
};
std::optional<CyclesPerStep> cycles_per_step(const Trace& trace);

// Of each phase what it takes of a node: the mean over nodes and steps, and the longest.
struct PhaseCycles {
  double mean = 0;
  uint64_t most = 0;
};
std::vector<PhaseCycles> cycles_per_phase(const Trace& trace);

}  // namespace cuboct
