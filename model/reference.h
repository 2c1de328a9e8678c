// SPDX-License-Identifier: MIT
// The real-number engine: the rule in doubles, the physics that everything else is measured against, or in floats.
#pragma once

#include <cstdint>
#include <vector>

#include "model/neighbours.h"
#include "model/rule.h"

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
  int threads = 1;
  // Not 0: a particle's pairs are summed in an order drawn from it at each step, as by a machine without order.
  uint64_t order_seed = 0;
};

class Reference {
 public:
  // InputError where sizes or types of the body do not fit the rule, or the box is below 2 cutoffs. An empty
  // body.u means that every anchor stands at its particle.
  Reference(const Rule& rule, const Body& body, const Periodic& periodic, const RealOptions& options);
  Reference(const Rule& rule, const Body& body, const Periodic& periodic, Integrator integrator)
      : Reference(rule, body, periodic, RealOptions{.integrator = integrator}) {}

  // Advances `steps` steps. std::runtime_error, naming step and particle, where a position stops being
  // finite.
  void step(uint64_t steps = 1);
  uint64_t step_count() const { return step_; }

  // Positions are not wrapped into a periodic box: differences to earlier ones are displacements.
  const Body& body() const { return body_; }

  // Everything below is evaluated afresh at body()'s x and v.
  // Pair force on each particle, N: pair law and damping, without gravity and PD force.
  std::vector<Vec3> forces() const;
  // J; of the pair law alone.
  double potential_energy() const;
  double kinetic_energy() const;
  // kg m/s
  Vec3 momentum() const;
  // Virial stress of each particle, Pa, tension positive: sum over its pairs of f (x) d / 2 over `volume`
  // (m^3, per particle; fcc_volume(pitch) in a packing). The mean over a periodic box is the box's stress at
  // rest: the kinetic part -m v (x) v / volume is left out, as it would count the motion of a body as stress.
  // D. H. Tsai, J. Chem. Phys. 70 (1979) 1375.
  std::vector<Mat3> virial_stress(double volume) const;

 private:
  // Calls on(i, j, d, r, k) per interacting pair; the force on j is k*d, that on i is -k*d.
  template <class On>
  void for_each_force(On&& on) const;
  std::vector<Vec3> accelerations() const;
  // The parts of a step: v += a * dt with imposed velocities; x and u by v * dt.
  void kick(double dt);
  void drift(double dt);
  void sort();

  Rule rule_;
  Body body_;
  CellList cells_;
  Integrator integrator_;
  bool pd_ = false;
  uint64_t step_ = 0;
  std::vector<Vec3> a_;  // at the current x; of velocity Verlet, kept from the step before
};

}  // namespace cuboct
