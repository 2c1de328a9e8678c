// SPDX-License-Identifier: MIT
// Quasi-static loading behind the interface of all engines: the scene's time steps count the load, and the
// body is at rest at each load step. In doubles: the fixed rule's integers know forces as kicks of a step,
// whose last bit is far above the residual that rest asks for.
//
// Step 0 is the body before its load: at rest without gravity and the forces of pulled constraints. One that
// another run left, or that nothing loads, is as it is. The first step brings it to rest under those forces;
// each load step then moves the constraints on.
#pragma once

#include "model/real/balance.h"
#include "model/run/engine.h"
#include "model/run/record.h"
#include "model/scene/scene.h"

namespace cuboct {

// The counter of force evaluations.
inline constexpr const char* kEvaluations = "force_evaluations";

class StaticEngine : public Engine {
 public:
  // Keeps a reference to `scene`, whose `loading` it follows. `cell_edge`: m, in which speeds are told.
  // StepError where the body finds no rest.
  StaticEngine(const Scene& scene, const Body& body, int threads, double cell_edge);
  // From what an engine of this scene left at `step`: its body, and memory().own. InputError where that is
  // another's.
  StaticEngine(const Scene& scene, const Body& body, int threads, double cell_edge, uint64_t step,
               const std::vector<uint64_t>& own);

  uint64_t step_count() const override { return step_; }
  // Between two load steps only the count moves.
  void advance(uint64_t steps, std::vector<uint64_t>*) override;
  RunState frame(bool forces) override;
  Reading read(const Asked& asked) override;
  Momentum momentum() override { return {}; }
  double largest_speed() override;
  Counters counters() override;
  Counters counters_of_state() override;
  Notes notes() override;
  const Body* saved_body() override { return &balance_.body(); }
  EngineMemory memory() override;

 private:
  void relax();

  const Scene& scene_;
  int threads_;
  double cell_edge_;
  uint64_t step_;
  Balance balance_;
  bool rests_ = false;  // under the load that acts without a load step
  uint64_t load_steps_ = 0, evaluations_ = 0;
  double largest_share_ = 0;     // of the load, of any load step
  double largest_residual_ = 0;  // N, where nothing is loaded
};

// InputError where the scene's box deforms, of `who` that knows a box of one size: "the lattice engine".
void refuse_deform(const Scene& scene, const std::string& who);

// InputError where the scene asks for static loading, of `who` that knows motion alone: "the lattice engine".
void refuse_static(const Scene& scene, const std::string& who);

}  // namespace cuboct
