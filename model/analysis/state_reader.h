// SPDX-License-Identifier: MIT
// Readings of one run's states, one after another: what it costs to find near pairs is shared between them.
#pragma once

#include <optional>
#include <vector>

#include "model/analysis/near_pairs.h"
#include "model/analysis/particle_stress.h"
#include "model/analysis/reading.h"
#include "model/base/mat3.h"

namespace cuboct {

// As in measure.h, of a state that `near` has taken.
Energies energies(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                  const State& state, const std::vector<Int3>& kicks, const NearPairs& near, int threads,
                  ClosestPair* closest, std::vector<PairAcross>* across);
// `across`: as energies() finds them.
Mat3 virial_stress(const FixedRule& rule, const Lattice& lattice, const State& state, double volume,
                   const std::vector<Int3>& kicks, const NearPairs& near,
                   const std::vector<PairAcross>& across);

// `unit`: velocity_units of the rule.
Vec3 velocity_of(const FixedRule& rule, const Particle& particle, const Int3& kick, const Vec3& unit);

// What is asked of single particles.
class ParticleReader {
 public:
  // References outlive it.
  ParticleReader(const FixedRule& fixed, const Lattice& lattice, const Vec3& origin, const Asked& asked);
  // `kick`: the sum of its pairs; zero where nobody asks.
  void add(const Particle& particle, const Int3& kick, Reading& reading) const;
  // For so many.
  void make_room(size_t particles, Reading& reading) const;

 private:
  const FixedRule& fixed_;
  const Lattice& lattice_;
  const Vec3& origin_;
  bool forces_, velocities_;
  Vec3 length_, speed_, newtons_;  // of a unit of position, velocity, kick
};

// Reads the states of one run, in the order of their steps.
class StateReader {
 public:
  // References outlive it. `threads`: 0 for one per core; no bit depends on their number.
  StateReader(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
              int threads);
  // `kicks`: summed_kicks of the state, where the engine has them; empty: they are summed here.
  Reading read(const State& state, const Asked& asked, std::vector<Int3> kicks = {});

 private:
  const Rule& rule_;
  const FixedRule& fixed_;
  const Lattice& lattice_;
  const Vec3& origin_;
  int threads_;
  NearPairs near_;
  std::optional<ParticleStress> stress_;  // once it is asked for
};

// Whether a reading takes the sums of the pairs' kicks.
inline bool takes_kicks(const Asked& asked) { return takes_forces(asked); }

}  // namespace cuboct
