// SPDX-License-Identifier: MIT
#include "hw/state_bounds.h"

#include <fmt/format.h>

namespace cuboct {

Particle checked_particle(CheckpointReader& from, const Plan& plan) {
  const Particle particle = from.next();
  const std::string wrong = out_of_bounds(particle, bounds_of(plan));
  if (wrong.empty()) return particle;
  throw InputError(fmt::format("{} is damaged: particle {}: {}", from.path(), particle.id, wrong));
}

}  // namespace cuboct
