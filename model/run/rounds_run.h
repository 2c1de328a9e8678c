// SPDX-License-Identifier: MIT
// A rule of several rounds behind the interface of all engines.
#pragma once

#include <memory>
#include <span>
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
  uint64_t hash() override;
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
  std::vector<double> damage() const;
  // What the rule shows of its particles, by name: [particle x its numbers]. With "damage" where bonds break.
  std::vector<std::pair<std::string, std::vector<double>>> shown();

 protected:
  const Body& body();
  // Fills body_ from the engine's state, where that has gone on.
  virtual void renew();
  // As Reading::fields.
  std::vector<std::vector<double>> fields_of(std::span<const uint32_t> ids);

  const Scene& scene_;
  uint64_t step_;
  bool stale_ = false;
  Body body_;
  std::unique_ptr<RealEngine> engine_;

 private:
  std::unique_ptr<RealOptions> options_;
  double cell_edge_;
};

// As engines of rounds begin: with bonds, and displacements from anchors where some type is held by force.
Body completed(const Scene& scene, const Body& start);

// From `start` instead of the scene's body.
EngineKind rounds_kind(const Scene& scene, const Body& start, const RealOptions& options, double cell_edge);

}  // namespace cuboct
