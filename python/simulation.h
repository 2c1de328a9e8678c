// SPDX-License-Identifier: MIT
// A scene in an engine that is stepped from outside: in this process, or in a program of its own that is run
// for each piece. Any thread may call any function: one waits for the other.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cli/run/engine_options.h"
#include "emu/lattice/run.h"
#include "model/analysis/meter.h"
#include "model/analysis/strain.h"
#include "model/run/engine.h"
#include "python/page.h"
#include "python/sources.h"

namespace cuboct::python {

// A step could not be done; the state before it stands.
class Stopped : public std::runtime_error {
 public:
  // `advice`: what a user can do; empty where nothing is known.
  Stopped(const StopReason& reason, const std::string& advice)
      : std::runtime_error(reason.text), reason(reason), advice(advice) {}
  StopReason reason;
  std::string advice;
};

struct EnergiesNow {
  Energies of;
  std::optional<double> temperature;  // K, in reduced units J; of a scene that has one
};

class Simulation {
 public:
  // An empty `engine`: the one that the scene asks for. `probe_every`: steps between two readings of probes
  // and energies, 0: none; nothing: the scene's, of each. `anyway`: though it needs more memory than is free.
  Simulation(const Sources& sources, const std::string& engine, const EngineOptions& options,
             std::optional<uint64_t> probe_every, bool anyway = false);

  // Throw Stopped, and Interrupted after a whole step. Of static loading a step moves the load's count, and
  // the body follows at whole load steps.
  void step(uint64_t steps);
  void run();  // to the scene's last step, or to where its `until` holds

  uint64_t step_count();
  Body body();      // the index is the particle's id; velocities live half a step before the positions, but
                    // for velocity Verlet
  uint64_t hash();  // of fixed engines
  uint64_t plan_hash();
  EnergiesNow energies();
  std::vector<Curve> curves();
  void leave(const std::string& directory);  // the present state, where another run may begin
  Fields fields();

  // m/s, of all particles that the constraint holds or moves, from the next step on.
  void set_velocity(const std::string& constraint, const Vec3& velocity);
  void set_gravity(const Vec3& gravity);  // m/s^2

  // PNG, of the present state.
  std::string picture(const std::string& field, double limit, int width);

  // The present state and the curves so far.
  Shown shown();

  // Never change.
  const std::string& engine() const { return engine_name_; }
  bool real() const { return real_; }
  double dt() const { return scene_.rule.dt; }
  uint64_t particles() const { return scene_.body.size(); }
  const std::string& title() const { return scene_.title; }
  std::vector<std::string> type_names() const;
  std::vector<double> type_masses() const;  // kg

 private:
  void make_engine();
  std::unique_ptr<Engine> engine_of_text();
  void go_to(uint64_t end, bool until);
  bool is_over() const;
  void advance(uint64_t steps);
  [[noreturn]] void stop(const StopReason& reason);
  void read_probes(bool energies);
  const Reading& reading();
  const Body& present();
  StrainMeter& strain();
  uint64_t piece(uint64_t steps) const;
  void change(const std::string& call, const std::function<void(Rule&)>& edit);
  uint64_t now() const { return engine_->step_count(); }

  std::mutex mutex_;
  Scene scene_;  // its body is the initial one
  Setup setup_;  // the state is that from which the engine was made
  Body start_;   // the same of an engine in real numbers, and what else it kept there
  std::vector<uint64_t> own_;
  std::string engine_name_;
  EngineOptions options_;
  Sources sources_;
  bool real_ = false, program_ = false;  // program_: the engine is one
  bool changed_ = false;                 // from what the scene says
  bool text_ = false;                    // a rule that is text, in integers: states are shown in real numbers
  uint64_t first_step_ = 0;              // of the engine
  uint64_t probe_every_ = 0, energy_every_ = 0;
  emu::LatticeChoice lattice_;
  std::unique_ptr<Engine> engine_;
  std::optional<Meter> meter_;
  std::optional<StrainMeter> strain_;  // against the initial state
  std::optional<Reading> reading_;     // those of the present state, once asked for
  std::optional<Body> present_;
};

}  // namespace cuboct::python
