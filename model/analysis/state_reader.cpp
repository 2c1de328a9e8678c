// SPDX-License-Identifier: MIT
#include "model/analysis/state_reader.h"

namespace cuboct {

StateReader::StateReader(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                         int threads)
    : rule_(rule),
      fixed_(fixed),
      lattice_(lattice),
      origin_(origin),
      threads_(threads),
      near_(fixed, lattice, threads) {}

Reading StateReader::read(const State& state, const Asked& asked, std::vector<Int3> kicks) {
  Reading reading;
  reading.step = state.step;
  if (takes_kicks(asked) && kicks.empty()) kicks = summed_kicks(fixed_, lattice_, state, threads_);
  for (const uint32_t id : asked.ids) {
    const Particle& particle = state.particles[id];
    reading.x.push_back(position_of(fixed_, lattice_, origin_, particle));
    reading.force.push_back(force_of(fixed_, kicks.empty() ? Int3{} : kicks[id]));
    if (asked.velocities) reading.v.push_back(velocity_of(fixed_, particle, kicks[id]));
  }
  if (!asked.energies) return reading;
  near_.take(state);
  ClosestPair closest;
  std::vector<PairAcross> across;
  reading.energies =
      energies(rule_, fixed_, lattice_, origin_, state, kicks, near_, threads_, &closest, &across);
  if (asked.watch) asked.watch->see(fixed_, lattice_, origin_, state, kicks, reading.energies, closest);
  if (asked.volume > 0)
    reading.stress = virial_stress(fixed_, lattice_, state, asked.volume, kicks, near_, across);
  return reading;
}

}  // namespace cuboct
