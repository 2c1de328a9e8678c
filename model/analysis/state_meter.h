// SPDX-License-Identifier: MIT
// The curves of a run, from states that come one by one: the scene's probes and, where asked, the energies.
// Every engine's run is measured here.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "model/analysis/energy_curves.h"
#include "model/analysis/measure.h"
#include "model/analysis/watch.h"

namespace cuboct {

class StateMeter {
 public:
  // `initial(id)`: the particle at step 0; called for those in a probe's set alone. Keeps references to
  // scene, rule and lattice. `watch`: look for what fails as well; of use with `energies` alone.
  StateMeter(const Scene& scene, const FixedRule& rule, const Lattice& lattice, const Vec3& origin,
             const std::function<Particle(uint32_t)>& initial, bool energies, int threads = 0,
             bool watch = false);

  // States come in the order of steps, sorted by id.
  void add(const State& state);

  // Probe curves, then energy.kinetic, energy.potential, energy.gravity and energy.total in J, then, where
  // the scene has them, temperature in K and pressure in Pa.
  std::vector<Curve> curves() const;

  // The last value of each curve, once there is one.
  std::vector<double> latest() const;

  // After the last state, before findings are read.
  void conclude() {
    if (watch_) watch_->conclude();
  }
  // Null where nobody watches.
  const Watch* watch() const { return watch_ ? &*watch_ : nullptr; }

  // For checkpoints.
  ProbeMeter::Memory memory() const { return probes_.memory(); }
  size_t probed() const { return ids_.size(); }  // particles in `memory`
  void restore(ProbeMeter::Memory memory, const std::vector<Curve>& curves);

 private:
  const Scene& scene_;
  const FixedRule& rule_;
  const Lattice& lattice_;
  Vec3 origin_;
  std::vector<uint32_t> ids_;  // particles in any probe's set, ascending: the probes' ids index this list
  ProbeMeter probes_;
  EnergyCurves energy_;
  bool forces_ = false;  // some probe needs them
  int threads_;
  std::optional<Watch> watch_;
};

// The steps 0, every, 2 every, ... up to `last`; none for every 0.
std::vector<uint64_t> probe_steps_of(const Scene& scene, uint64_t last);

}  // namespace cuboct
