// SPDX-License-Identifier: MIT
// What probes, energies and a watch take from one state of a run, whoever computes it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "model/analysis/measure.h"
#include "model/analysis/watch.h"
#include "model/base/mat3.h"
#include "model/real/reference.h"

namespace cuboct {

// A set of particles whose stress is wanted.
struct AskedStress {
  std::span<const uint32_t> ids;  // not of `all`
  bool all = false;
  bool kinetic = true;  // with the part of the motion
};

struct Asked {
  std::span<const uint32_t> ids;  // whose positions are wanted, ascending
  bool forces = false;            // of those particles
  bool velocities = false;        // of those particles
  bool energies = false;
  bool fields = false;  // of those particles, what the rule's declaration shows
  std::span<const AskedStress> stress = {};
  double volume = 0;       // m^3: with energies, the virial stress over it; 0: none
  Watch* watch = nullptr;  // to be shown the state; of use with energies alone
};

struct Reading {
  uint64_t step = 0;
  // In the order of the ids: m; N of the pairs, zero where not asked for; m/s at the time of the positions,
  // empty where not asked for.
  std::vector<Vec3> x, force, v;
  // [field of the rule][numbers of each particle, one after another]; empty where not asked for.
  std::vector<std::vector<double>> fields = {};
  Energies energies;
  Mat3 stress = Mat3::Zero();  // Pa, tension positive, without its kinetic part
  // Of each set of Asked::stress, J: the sum over its particles of stress times volume, tension positive; as
  // ParticleStress::of (model/analysis/particle_stress.h).
  std::vector<Mat3> stress_volume = {};
};

// Whether a reading takes all particles' velocities at the time of their positions.
bool takes_velocities(const Asked& asked);
// Whether it takes the forces of the pairs, by which those velocities are known.
bool takes_forces(const Asked& asked);

// `threads`: 0 for one per core; no bit depends on their number.
Reading read_state(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                   const State& state, const Asked& asked, int threads);

// `late`: s, from the time of the velocities to that of the positions.
Reading read_reference(const Rule& rule, const Reference& reference, double late, const Asked& asked);

}  // namespace cuboct
