// SPDX-License-Identifier: MIT
// What a state means in real units: forces, energies, momentum, and the curves of a scene's probes. Nothing
// here knows which engine made the state.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "model/analysis/crack.h"
#include "model/base/mat3.h"
#include "model/contract/fixed_rule.h"
#include "model/contract/lattice.h"
#include "model/contract/state.h"
#include "model/scene/scene.h"
#include "model/trace/trace.h"

namespace cuboct {

// Sum of the pair kicks on each particle, in the order of `state.particles`; P+G fractional bits of a cell
// edge per step. It is what the machine adds up in the step that begins with `state`.
// `threads` (0: one per core) share the cells; no bit depends on their number, here and in `energies`.
std::vector<Int3> summed_kicks(const FixedRule& rule, const Lattice& lattice, const State& state,
                               int threads = 0);

// Newtons per unit of a kick along each axis: a kick of one cell edge per step is that edge/dt in velocity,
// gained within dt.
Vec3 newtons_per_kick(const FixedRule& rule);
Vec3 force_of(const FixedRule& rule, const Int3& kick);  // N
// m/s, at the time of the positions: v + dv/2 with all that the step adds to v, which lives half a step
// earlier.
Vec3 velocity_of(const FixedRule& rule, const Particle& particle, const Int3& kick);

// The particles along the axes that nothing imposes or steers, at the time of the positions.
struct FreeMotion {
  double kinetic = 0;              // J
  Vec3 velocities = Vec3::Zero();  // m/s, summed, each times its mass over the lightest
};

struct Energies {
  double kinetic = 0;    // J, at the time of the positions
  double potential = 0;  // J, of the pairs, by the pair law in doubles at the fixed positions
  double gravity = 0;    // J, -m g.x summed, from the origin of the scene's coordinates
  FreeMotion free = {};  // a part of `kinetic`
  double total() const { return kinetic + potential + gravity; }
};

// The two particles that are nearest to each other inside the cutoff; r infinite where none are.
struct ClosestPair {
  uint32_t i = 0, j = 0;                               // ids, i < j
  double r = std::numeric_limits<double>::infinity();  // m
};

Energies energies(const Rule& rule, const FixedRule& fixed, const Lattice& lattice, const Vec3& origin,
                  const State& state, const std::vector<Int3>& kicks, int threads = 0,
                  ClosestPair* closest = nullptr);

// Of particle `i` in real units, m/s^2, at body's x, v and u: the pair force (N), the PD force and gravity; 0
// along axes whose velocity is imposed.
Vec3 acceleration(const Rule& rule, const Body& body, size_t i, const Vec3& force);

// Virial stress of the whole body over `volume` (m^3), Pa, tension positive: the sum over pairs of f (x) d by
// the kicks that the machine adds up and the positions that it holds. In a periodic box the mean of
// Reference::virial_stress, which leaves out the kinetic part too.
Mat3 virial_stress(const FixedRule& rule, const Lattice& lattice, const State& state, double volume,
                   int threads = 0);

// Of a box that repeats along all axes, Pa: 2/3 of the kinetic energy over the volume, less a third of the
// trace of the virial stress. R. Clausius, Phil. Mag. 40 (1870) 122. Kinetic energy is that in the scene's
// frame, also of a body that moves as a whole.
double pressure(const Energies& energies, const Mat3& virial_stress, double volume);

// Whether a run of the rule keeps its energy: nothing damps, drives or steers, and no gravity acts along a
// ring.
bool keeps_energy(const Rule& rule, const Periodic& periodic);
// Whether a run keeps the sum of all particles' velocities: nothing holds, drives, steers or weighs.
bool keeps_momentum(const Rule& rule);

// Largest |v| along an axis, as a fraction of one cell per step.
double largest_speed(const FixedRule& rule, const State& state);

// Particles at one time in real units; the index is the particle's id.
struct Sample {
  uint64_t step = 0;
  std::vector<Vec3> x;                           // m; an axis with a period may be given in any image
  std::vector<Vec3> force;                       // N, of the pairs
  std::vector<Vec3> v;                           // m/s, at the time of the positions
  std::vector<std::vector<double>> fields = {};  // as Reading::fields
  std::vector<Mat3> stress_volume = {};          // J, of each stress probe; as Reading::stress_volume
  double box_volume = 0;                         // m^3, now; of a box that repeats along all axes
  Vec3 box_strain = Vec3::Zero();                // 1, of the lengths as packed
};

Sample sample_of(const FixedRule& rule, const Lattice& lattice, const Vec3& origin, const State& state,
                 const std::vector<Int3>& kicks);

// Particles in any probe's set, ascending.
std::vector<uint32_t> probed_ids(const std::vector<Probe>& probes);
// The probes with their ids replaced by places in `ids`, for samples that hold the probed particles alone.
std::vector<Probe> placed(std::vector<Probe> probes, const std::vector<uint32_t>& ids);

// Turns samples into the curves of a scene's probes:
//   force          <name>.force_x, .force_y, .force_z   N; with an axis <name>.force
//   displacement   <name>.x, .y, .z                     m; with an axis <name>.along
//   stress_strain  <name>.strain                        1
//                  <name>.stress                        Pa, positive where the body pulls at the grip
//   crack          <name>.broken                        1, bonds
//                  <name>.length                        m, of the largest cluster of broken bonds
//                  <name>.speed                         m/s, growth of the length over the last readings
//                  <name>.energy                        J, what held the broken bonds at step 0
//   velocity       <name>.velocity_x, _y, _z            m/s; with an axis <name>.velocity
//   kinetic_energy <name>.kinetic_energy                J
//   temperature    <name>.temperature                   K, in reduced units J
//   stress         <name>.xx, .yy, .zz, .xy, .xz, .yz   Pa, positive in tension
//                  <name>.strain_x, .strain_y, .strain_z  1, of the box, along axes that repeat
class ProbeMeter {
 public:
  // `initial`: positions at step 0, from which displacements and strains count.
  ProbeMeter(const std::vector<Probe>& probes, const Periodic& periodic, const std::vector<Vec3>& initial);

  // The box of the samples from now on: of the same axes.
  void set_box(const Periodic& periodic) { periodic_ = periodic; }
  // Samples come in the order of steps, close enough that no particle moves half a period between two of
  // them.
  void add(const Sample& sample);
  const std::vector<Curve>& curves() const { return curves_; }

  // What the next sample counts on from, to keep with a checkpoint: the latest positions and the displacement
  // since step 0, in m.
  struct Memory {
    std::vector<Vec3> latest, moved;
  };
  Memory memory() const { return {latest_, moved_}; }
  // Goes on from a memory of the same probes and from their curves so far.
  void restore(Memory memory, std::vector<Curve> curves);

 private:
  std::vector<Probe> probes_;
  std::vector<CrackMeter> cracks_;  // of the probes of that kind, in their order
  Periodic periodic_;
  std::vector<Vec3> initial_, latest_, moved_;
  std::vector<Curve> curves_;
};

}  // namespace cuboct
