// SPDX-License-Identifier: MIT
// The curves of a run in real numbers, the same as those of model/analysis/state_meter.h for the fixed
// engines.
#pragma once

#include <vector>

#include "model/analysis/energy_curves.h"
#include "model/analysis/measure.h"
#include "model/analysis/watch.h"
#include "model/real/reference.h"

namespace cuboct {

class RealMeter {
 public:
  // Keeps a reference to `scene`. `integrator`, of the run, tells when velocities live. `probes`, `energies`:
  // which curves are wanted.
  RealMeter(const Scene& scene, Integrator integrator, bool probes, bool energies);

  // The state as it stands; they come in the order of steps. `watch` looks at it too, where energies are
  // wanted.
  void add(const Reference& reference, Watch* watch = nullptr);

  // Probe curves, then energy.kinetic, energy.potential, energy.gravity and energy.total in J, then, where
  // the scene has them, temperature in K and pressure in Pa.
  std::vector<Curve> curves() const;

 private:
  const Scene& scene_;
  double late_;  // s, from the time of the velocities to that of the positions
  ProbeMeter probes_;
  EnergyCurves energy_;
};

}  // namespace cuboct
