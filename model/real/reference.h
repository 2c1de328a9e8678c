// SPDX-License-Identifier: MIT
// The real-number engine: the rule in doubles, the physics that everything else is measured against, or in
// floats.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "model/base/mat3.h"
#include "model/contract/box_deformation.h"
#include "model/contract/rule.h"

namespace cuboct {

enum class Integrator : uint8_t {
  // The contract of the fixed engines without their rounding; v lives half a step behind x:
  //   a = (pair forces at x, damping by v; PD force by u and v)/m + gravity
  //   v += a dt, imposed axes take their velocity, u += (v - V) dt, x += v dt
  semi_implicit_euler,
  // v and x at full steps; dt^2 in energy where nothing damps:
  //   v += a dt/2, impose, u += (v - V) dt, x += v dt, a as above with these x, u and v, v += a dt/2, impose
  // Damping and PD force see the velocity of the half step, explicitly: first order in dt where they act.
  velocity_verlet,
};

enum class Precision : uint8_t {
  float64,
  // Positions (absolute, as most codes hold them), velocities, differences, law, damping and sums in floats.
  float32,
};

struct RealOptions {
  Integrator integrator = Integrator::semi_implicit_euler;
  Precision precision = Precision::float64;
  int threads = 1;  // at least 1; leave no mark in the bits
  // 0: a particle's pairs are summed by ascending id of the other. Else in an order drawn from it anew at
  // each step, as by a machine without order.
  uint64_t order_seed = 0;
  uint64_t first_step = 0;  // the step that the body is the state of
  // Of a box that changes its lengths: each step first carries the particles with it, from the box of the
  // step before to its own, and leaves their velocities. The periodic box that an engine is given is that of
  // `first_step`. None: it keeps its lengths.
  std::optional<BoxDeformation> deform = {};
  // Rounds are run when somebody asks for what they make: of a state that another engine moves.
  bool on_demand = false;
};

// Threads that pay for themselves on this machine.
int reference_threads(size_t particles);

class RealEngine;
class RoundsTerms;

// A particle's sum runs over its own pairs by ascending id of the other, each rounded in the same way
// whatever computes it: the bits are a function of rule, body and integrator, not of threads, vectors or
// neighbour lists.
class Reference {
 public:
  // InputError where sizes or types of the body do not fit the rule, or the box is below 2 cutoffs. An empty
  // body.u means that every anchor stands at its particle.
  Reference(const Rule& rule, const Body& body, const Periodic& periodic, const RealOptions& options = {});
  Reference(const Rule& rule, const Body& body, const Periodic& periodic, Integrator integrator)
      : Reference(rule, body, periodic, RealOptions{.integrator = integrator}) {}
  ~Reference();
  Reference(Reference&&) noexcept;
  Reference& operator=(Reference&&) noexcept;

  // Advances `steps` steps. std::runtime_error, naming step and particle, where a position stops being
  // finite.
  void step(uint64_t steps = 1);
  uint64_t step_count() const { return step_; }

  // The state becomes that of `body`, of the same particles; the step count stays. For those who ask for
  // forces: velocity Verlet would go on with the forces of before.
  void place(const Body& body);
  // The bonds of a rule of rounds give way as the state stretches them, as they do in a step.
  void give_way();

  // Positions are not wrapped into a periodic box: differences to earlier ones are displacements. The first
  // call after a step copies; it is not safe beside another.
  const Body& body() const;

  // Everything below is evaluated afresh at body()'s x and v.
  // Pair force on each particle, N: pair law and damping, without gravity and PD force; in the precision of
  // the steps.
  std::vector<Vec3> forces() const;
  // The rest is evaluated in doubles whatever the precision of the steps: it shows the state, not its own
  // rounding. J; of the pair law alone.
  double potential_energy() const;
  double kinetic_energy() const;
  // kg m/s
  Vec3 momentum() const;
  // m/s, along an axis, of any particle since the start.
  double largest_speed() const;
  // Virial stress of each particle, Pa, tension positive: sum over its pairs of f (x) d / 2 over `volume`
  // (m^3, per particle; fcc_volume(pitch) in a packing). The mean over a periodic box is the box's stress at
  // rest: the kinetic part -m v (x) v / volume is left out, as it would count the motion of a body as stress.
  // D. H. Tsai, J. Chem. Phys. 70 (1979) 1375.
  std::vector<Mat3> virial_stress(double volume) const;
  // Of a rule of rounds; null: it is of pairs.
  const RoundsTerms* terms() const;

  // How often neighbour lists were made, and the instruction set that evaluates pairs, e.g. "AVX3".
  uint64_t lists_made() const;
  static const char* simd();

 private:
  Rule rule_;
  int threads_;
  uint64_t step_ = 0;
  std::unique_ptr<RealEngine> engine_;
  mutable Body body_;  // as of the last call of body()
  mutable bool stale_ = true;
};

}  // namespace cuboct
