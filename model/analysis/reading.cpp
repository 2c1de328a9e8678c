// SPDX-License-Identifier: MIT
#include "model/analysis/reading.h"

#include <algorithm>
#include <numeric>

#include "model/analysis/body_reading.h"
#include "model/analysis/state_reader.h"

namespace cuboct {

bool takes_velocities(const Asked& asked) {
  return asked.velocities || asked.energies || std::ranges::any_of(asked.stress, &AskedStress::kinetic);
}

bool takes_forces(const Asked& asked) { return asked.forces || takes_velocities(asked); }

Reading read_state(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                   const State& state, const Asked& asked, int threads) {
  return StateReader(rule, fixed, lattice, origin, threads).read(state, asked);
}

Reading read_reference(const Rule& rule, const Reference& reference, double late, const Asked& asked) {
  const Body& body = reference.body();
  std::vector<Vec3> force, v;
  if (takes_forces(asked)) force = reference.forces();
  if (takes_velocities(asked)) v = velocities_at(rule, body, force, late);
  Reading reading = read_body(rule, body, force, v, asked);
  reading.step = reference.step_count();
  if (!asked.stress.empty())
    reading.stress_volume = summed_stress(rule, body.type, v, reference.virial_stress(1), asked.stress);
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
