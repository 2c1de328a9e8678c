// SPDX-License-Identifier: MIT
// The curves of a run, from readings that come one by one: the scene's probes and, where asked, the energies,
// with a watch over them. Every engine's run is measured here.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "model/analysis/energy_curves.h"
#include "model/analysis/reading.h"

namespace cuboct {

struct MeterOptions {
  bool probes = true;
  bool energies = false;
  bool watch = false;      // look for what fails wherever energies are read (model/analysis/watch.h)
  double table_error = 0;  // N, the largest error of the force that an engine's table makes
  int threads = 0;         // of the watch; 0: one per core
};

class Meter {
 public:
  // `initial(id)`: m, where the particle is at step 0; called for those in a probe's set alone. Keeps a
  // reference to `scene`.
  Meter(const Scene& scene, const std::function<Vec3(uint32_t)>& initial, const MeterOptions& options);

  // Of the curves, those that a reading is for.
  struct Parts {
    bool probes = true, energies = true;
  };
  // What is to be read of the engine at `step`. With `look`, the watch sees the state too, where energies are
  // read.
  Asked asked(const Parts& parts, bool look, uint64_t step);

  // Readings come in the order of steps.
  void add(const Reading& reading, const Parts& parts);

  // Probe curves, then energy.kinetic, energy.potential, energy.gravity and energy.total in J, then, where
  // the scene has them, temperature in K (reduced units: J) and pressure in Pa.
  std::vector<Curve> curves() const;
  // What was read of the last step that any was read of, if it is this one: a value of each curve, or of the
  // first ones.
  std::vector<double> values_at(uint64_t step) const;

  // After the last state, before findings are read.
  void conclude() {
    if (watch_) watch_->conclude();
  }
  // Null where nobody watches.
  const Watch* watch() const { return watch_ ? &*watch_ : nullptr; }

  // The last value of the probe's curve of this name, once there is one.
  std::optional<double> latest_of(const std::string& curve) const;

  // For checkpoints.
  ProbeMeter::Memory memory() const { return probes_.memory(); }
  size_t probed() const { return ids_.size(); }  // particles in `memory`
  void restore(ProbeMeter::Memory memory, const std::vector<Curve>& curves);

 private:
  const Scene& scene_;
  std::vector<uint32_t> ids_;  // particles in any probe's set, ascending: the probes' ids index this list
  ProbeMeter probes_;
  EnergyCurves energy_;
  bool forces_ = false, velocities_ = false, fields_ = false;  // some probe needs them
  std::vector<AskedStress> stress_;                            // of the probes of that kind, in their order
  std::optional<Watch> watch_;
};

// The steps 0, every, 2 every, ... up to `last` at which the scene's probes are read; none for every 0.
std::vector<uint64_t> probe_steps_of(const Scene& scene, uint64_t last);

}  // namespace cuboct
