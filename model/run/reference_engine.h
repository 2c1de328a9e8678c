// SPDX-License-Identifier: MIT
// The rule in real numbers behind the interface of all engines.
#pragma once

#include "model/run/checkpoint.h"
#include "model/run/engine.h"
#include "model/scene/scene.h"

namespace cuboct {

// StepError where the scene's box becomes too short for its rule in the step behind `step`.
void refuse_box(const Scene& scene, uint64_t step);

// The options with which an engine goes on from the scene's state after `step`: the box too.
RealOptions from_step(RealOptions options, const Scene& scene, uint64_t step);

class ReferenceEngine : public Engine {
 public:
  // Keeps a reference to `scene`; `body` may be another one than the scene's. `cell_edge`: m, in which speeds
  // are told. `step`: that of `body`.
  ReferenceEngine(const Scene& scene, const Body& body, const RealOptions& options, double cell_edge,
                  uint64_t step = 0);

  uint64_t step_count() const override { return reference_.step_count(); }
  // A step in which a position stops being finite takes the state with it.
  void advance(uint64_t steps, std::vector<uint64_t>*) override;
  RunState frame(bool forces) override;
  Reading read(const Asked& asked) override;
  Momentum momentum() override { return {{}, reference_.momentum()}; }
  double largest_speed() override;
  Counters counters() override { return {{"threads", options_.threads}}; }
  Notes notes() override;
  const Body& body() const { return reference_.body(); }
  const Body* saved_body() override { return &body(); }
  EngineMemory memory() override { return {{static_cast<uint64_t>(options_.precision)}, {}}; }

 private:
  const Scene& scene_;
  RealOptions options_;
  double cell_edge_;
  Reference reference_;
};

// The body of a checkpoint of an engine in real numbers, whose types are those of `start`, and whose bonds
// count from where those of `start` do. InputError where it is of another precision or number of particles.
Body saved_body(CheckpointReader& from, const Rule& rule, const Body& start, Precision precision);

}  // namespace cuboct
