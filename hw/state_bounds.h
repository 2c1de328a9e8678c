// SPDX-License-Identifier: MIT
#pragma once

#include "hw/plan.h"
#include "model/trace/state_check.h"

namespace cuboct {

inline StateBounds bounds_of(const Plan& plan) {
  return {plan.particles, plan.rule.types.size(), plan.lattice.size(), plan.rule.widths.velocity_frac(),
          plan.rule.widths.velocity_bits};
}

}  // namespace cuboct
