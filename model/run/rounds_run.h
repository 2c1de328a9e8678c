// SPDX-License-Identifier: MIT
// A rule of several rounds behind the interface of all engines.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/run/engine.h"
#include "model/run/record.h"
#include "model/scene/scene.h"

namespace cuboct {

class RealEngine;
struct RealOptions;

class RoundsRun : public Engine {
 public:
  // Keeps a reference to `scene`, whose rule has rounds. `cell_edge`: m, in which speeds are told. `step`: of
  // `body`. InputError where the body, or what its bonds keep, does not fit the rule.
  RoundsRun(const Scene& scene, const Body& body, const RealOptions& options, double cell_edge,
            uint64_t step = 0);
  ~RoundsRun() override;

  uint64_t step_count() const override { return step_; }
  void advance(uint64_t steps, std::vector<uint64_t>*) override;
  RunState frame(bool forces) override;
  Reading read(const Asked& asked) override;
  Momentum momentum() override;
  double largest_speed() override;
  Counters counters() override;
  Counters counters_of_state() override;
  Notes notes() override;
  const Body* saved_body() override;
  EngineMemory memory() override;

  // Whether the rule's bonds can break; of each particle's the share that did, as the last step left it.
  bool breaks() const;
  std::vector<double> damage();
  // What the rule shows of its particles, by name: [particle x its numbers].
  std::vector<std::pair<std::string, std::vector<double>>> shown();

 protected:
  const Body& body();
  // The reference engine at body(). Of options `on_demand` another engine makes the steps, and this one is
  // made when something is first asked for that the state does not tell.
  RealEngine& reference();
  // Fills body_ from the state, where that has gone on.
  virtual void renew();
  // The reference becomes the state of body(), where another engine makes the steps.
  virtual void follow(RealEngine&) {}

  // Of the state, by id. N, on each particle, without gravity and controllers.
  virtual std::vector<Vec3> forces();
  // m/s, at the time of the positions. `force`: forces(), or empty where nobody asked for them.
  virtual std::vector<Vec3> velocities(const std::vector<Vec3>& force);
  // As RoundsTerms::shown.
  virtual std::vector<std::vector<double>> fields();
  // Whether steps hand on all that fields() shows: the state has it, and no round need be run.
  bool hands_on_fields() const;

  const Scene& scene_;
  uint64_t step_;
  bool stale_ = false;
  Body body_;

 private:
  void make_reference(const Body& start);

  std::unique_ptr<RealOptions> options_;
  double cell_edge_;
  std::unique_ptr<RealEngine> engine_;
  Body start_;           // on demand: what the reference begins with, until it is made
  bool behind_ = false;  // the reference is not at body()
};

// As engines of rounds begin: with bonds, and displacements from anchors where some type is held by force.
Body completed(const Scene& scene, const Body& start);

}  // namespace cuboct
