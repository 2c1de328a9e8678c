// SPDX-License-Identifier: MIT
// Atoms under Tersoff's potential in time: molecular dynamics at constant energy, loads and driven edges, and
// rest. Units are those of the parameters, with any mass: time is in sqrt(mass length^2/energy). In SI all is
// SI.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/atoms/bond_order/tersoff_forces.h"
#include "model/base/mat3.h"

namespace cuboct {

// What acts on the atoms from outside. A list is empty, or has an entry for each atom.
struct AtomLoads {
  std::vector<Vec3> force;                   // body force
  std::vector<std::array<bool, 3>> imposed;  // axes along which `velocity` is imposed; held where that is 0
  std::vector<Vec3> velocity;
};

struct AtomSystem {
  AtomBox box;
  std::vector<Vec3> x, v;        // v empty: at rest
  std::vector<uint8_t> element;  // empty: all are the first
  std::vector<double> mass;      // of each element
};

struct AtomMotionOptions {
  double dt = 0;
  double skin = 0;  // 0: a tenth of the cutoff
  int threads = 1;  // leave no mark in the bits
  double drag = 0;  // 1/time: every free velocity falls by exp(-drag dt) a step; 0: energy is kept
};

class AtomMotion {
 public:
  // std::invalid_argument where sizes do not fit, a mass is not positive or there is no atom.
  AtomMotion(const Tersoff& tersoff, AtomSystem system, const AtomMotionOptions& options);

  // From the next step on.
  void load(AtomLoads loads);
  // Velocity Verlet: v += a dt/2, x += v dt, a at these x, v += a dt/2; imposed axes have their velocity all
  // along. std::runtime_error, naming step and atom, where a position is not finite.
  void step(uint64_t steps = 1);

  struct Rest {
    bool reached = false;
    uint64_t evaluations = 0;
    double force = 0;  // the largest that is left on an axis that is free, loads included
  };
  // The nearest rest downhill by FIRE: axes that are imposed stay where they are. Velocities end at 0.
  Rest rest(double force, uint64_t most = 100000);
  // Box and atoms by `deformation`.
  void deform(const Mat3& deformation);

  const AtomSystem& atoms() const { return system_; }
  // Of the potential alone, without loads.
  const std::vector<Vec3>& forces() const { return f_; }
  uint64_t steps() const { return steps_; }
  uint64_t lists_made() const { return list_.made(); }
  double potential_energy();
  double kinetic_energy() const;
  Vec3 momentum() const;
  // dE/dstrain, and what one atom has of it: over volumes stresses, tension positive, without the motion's
  // own.
  Mat3 virial();
  Mat3 virial_of(size_t atom);

 private:
  void evaluate(bool sums);
  void kick(double time);
  double mass_of(size_t i) const { return system_.mass[system_.element.empty() ? 0 : system_.element[i]]; }
  bool is_free(size_t i, int axis) const { return loads_.imposed.empty() || !loads_.imposed[i][axis]; }
  double stiffest();

  AtomSystem system_;
  AtomMotionOptions options_;
  AtomLoads loads_;
  TersoffForces tersoff_;
  BondList list_;
  std::vector<Vec3> f_;
  bool sums_ = false;  // energy and virial are those of x
  uint64_t steps_ = 0;
};

}  // namespace cuboct
