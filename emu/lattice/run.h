// SPDX-License-Identifier: MIT
// The lattice engine behind the interface of all engines.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "emu/lattice/engine.h"
#include "model/run/integer_engine.h"
#include "model/run/record.h"
#include "model/scene/scene.h"

namespace cuboct::emu {

struct LatticeChoice {
  LatticeOptions engine;
  // A state of the plan to go on from, particles sorted by id, in place of the scene's body; null: that.
  const State* from = nullptr;
  // Where memory is short: the scene's own body, which is used up, and how to get it again if need be.
  Body* spare = nullptr;
  std::function<Body()> body_again{};
};

// `plan` is the scene's. The engine loses its state in a step that fails. References are kept.
// Counters of the trace: cycles where they are counted, list_builds, node_steps, quiet_node_steps, threads.
EngineKind lattice_kind(const Scene& scene, const Plan& plan, const LatticeChoice& choice);

// Of its name; an empty one: automatic.
RuleCode rule_code_of(const std::string& name);

// A rule that is text, from a state of the plan.
std::unique_ptr<IntegerEngine> integer_lattice(const Plan& plan, const State& from,
                                               const LatticeOptions& options);

// A whole run.
struct LatticeRun : RunRequest {
  LatticeOptions engine;
};
Recorded run_lattice(const Scene& scene, const Plan& plan, const LatticeRun& request);

}  // namespace cuboct::emu
