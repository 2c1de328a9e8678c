// SPDX-License-Identifier: MIT
#include "model/analysis/reading.h"

#include <numeric>

#include "model/analysis/body_reading.h"

namespace cuboct {

Reading read_state(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                   const State& state, const Asked& asked, int threads) {
  Reading reading;
  reading.step = state.step;
  std::vector<Int3> kicks;
  if (asked.forces || asked.velocities || asked.energies)
    kicks = summed_kicks(fixed, lattice, state, threads);
  for (const uint32_t id : asked.ids) {
    reading.x.push_back(position_of(fixed, lattice, origin, state.particles[id]));
    reading.force.push_back(force_of(fixed, kicks.empty() ? Int3{} : kicks[id]));
    if (asked.velocities) reading.v.push_back(velocity_of(fixed, state.particles[id], kicks[id]));
  }
  if (!asked.energies) return reading;
  ClosestPair closest;
  reading.energies = energies(rule, fixed, lattice, origin, state, kicks, threads, &closest);
  if (asked.watch) asked.watch->see(fixed, lattice, origin, state, kicks, reading.energies, closest);
  if (asked.volume > 0) reading.stress = virial_stress(fixed, lattice, state, asked.volume, threads);
  return reading;
}

Reading read_reference(const Rule& rule, const Reference& reference, double late, const Asked& asked) {
  const Body& body = reference.body();
  std::vector<Vec3> force;
  if (asked.forces || asked.velocities || asked.energies) force = reference.forces();
  Reading reading = read_body(rule, body, force, late, asked);
  reading.step = reference.step_count();
  if (!asked.energies) return reading;
  reading.energies.potential = reference.potential_energy();
  if (asked.watch) asked.watch->see(reference.step_count(), body, force, reading.energies);
  if (asked.volume > 0) {
    const std::vector<Mat3> stress = reference.virial_stress(asked.volume);
    reading.stress = std::accumulate(stress.begin(), stress.end(), Mat3(Mat3::Zero()));
  }
  return reading;
}

}  // namespace cuboct
