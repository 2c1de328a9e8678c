// SPDX-License-Identifier: MIT
#include "model/analysis/state_reader.h"

#include "model/analysis/body_reading.h"

namespace cuboct {

ParticleReader::ParticleReader(const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                               const Asked& asked)
    : fixed_(fixed),
      lattice_(lattice),
      origin_(origin),
      forces_(asked.forces),
      velocities_(asked.velocities),
      length_(position_units(fixed)),
      speed_(velocity_units(fixed)),
      newtons_(newtons_per_kick(fixed)) {}

void ParticleReader::add(const Particle& particle, const Int3& kick, Reading& reading) const {
  const Cell& cell = lattice_.cell(particle.cell);
  const CellEdges edges = fixed_.edges();
  Vec3 x, force = Vec3::Zero();
  for (int a = 0; a < 3; ++a) {
    x[a] = origin_[a] + cell[a] * edges[a] + static_cast<double>(particle.x[a]) * length_[a];
    if (forces_) force[a] = newtons_[a] * static_cast<double>(kick[a]);
  }
  reading.x.push_back(x), reading.force.push_back(force);
  if (velocities_) reading.v.push_back(velocity_of(fixed_, particle, kick, speed_));
}

void ParticleReader::make_room(size_t particles, Reading& reading) const {
  reading.x.reserve(particles), reading.force.reserve(particles);
  if (velocities_) reading.v.reserve(particles);
}

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
  const ParticleReader particles(fixed_, lattice_, origin_, asked);
  particles.make_room(asked.ids.size(), reading);
  for (const uint32_t id : asked.ids)
    particles.add(state.particles[id], kicks.empty() ? Int3{} : kicks[id], reading);
  if (!asked.stress.empty()) {
    // By the pair law in doubles at the fixed positions, as the potential energy is.
    const CellEdges edges = fixed_.edges();
    Periodic box{.origin = origin_};
    for (int a = 0; a < 3; ++a) box.extent[a] = lattice_.period()[a] * edges[a];
    if (!stress_) stress_.emplace(rule_, box, threads_);
    std::vector<Vec3> v;
    for (size_t i = 0; i < kicks.size(); ++i) v.push_back(velocity_of(fixed_, state.particles[i], kicks[i]));
    const Body body = to_real(state, fixed_, lattice_, origin_);
    reading.stress_volume = summed_stress(rule_, body.type, v, stress_->virial(body), asked.stress);
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
