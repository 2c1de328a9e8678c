// SPDX-License-Identifier: MIT
// What a plan allows a particle's numbers to be, for particles that come from a file.
#pragma once

#include "hw/plan/plan.h"
#include "model/run/checkpoint.h"
#include "model/trace/state_check.h"

namespace cuboct {

inline StateBounds bounds_of(const Plan& plan) {
  return {plan.particles, plan.rule.types.size(), plan.lattice.size(), plan.rule.widths.velocity_frac(),
          plan.rule.widths.velocity_bits};
}

// The next particle of a checkpoint, which may be a stranger's. InputError where it cannot be of the plan, or
// is one of those that were `seen`: of each id, whether it came.
Particle checked_particle(CheckpointReader& from, const Plan& plan, std::vector<bool>& seen);
// All of them, in the order of the slots.
State checked_state(CheckpointReader& from, const Plan& plan);

}  // namespace cuboct
