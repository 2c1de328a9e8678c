// SPDX-License-Identifier: MIT
#include "hw/plan/state_bounds.h"

#include <fmt/format.h>

namespace cuboct {

Particle checked_particle(CheckpointReader& from, const Plan& plan, std::vector<bool>& seen) {
  const Particle particle = from.next();
  const std::string wrong = out_of_bounds(particle, bounds_of(plan));
  if (!wrong.empty())
    throw InputError(fmt::format("{} is damaged: particle {}: {}", from.path(), particle.id, wrong));
  if (seen[particle.id])
    throw InputError(fmt::format("{} is damaged: particle {} comes twice", from.path(), particle.id));
  seen[particle.id] = true;
  return particle;
}

State checked_state(CheckpointReader& from, const Plan& plan) {
  State state{from.head().step, {}};
  std::vector<bool> seen(plan.particles);
  for (uint32_t k = 0; k < plan.particles; ++k) {
    state.particles.push_back(checked_particle(from, plan, seen));
  }
  return state;
}

}  // namespace cuboct
