// SPDX-License-Identifier: MIT
// What a step will cost the machine, from how many particles each node holds.
#pragma once

#include <cstdint>

#include "hw/plan.h"
#include "model/state.h"

namespace cuboct {

struct ExpectedCycles {
  uint64_t ideal = 0;  // per step: what filter lanes and force pipes of the busiest node need at full use
  uint64_t step =
      0;  // per step: the slowest node's way through the phases of docs/reference/node.md, with none of its
          // particles leaving, no full queue, and neighbours that begin each phase when it does
};

ExpectedCycles expected_cycles(const Plan& plan, const State& state);

}  // namespace cuboct
