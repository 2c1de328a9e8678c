// SPDX-License-Identifier: MIT
// Which engine runs a scene, and with what plan. Static loading and rules of several rounds need the
// reference engine, but for rules that are text; no other place tells them from motion by a pair law.
#pragma once

#include <string>
#include <vector>

#include "hw/plan/plan.h"
#include "hw/plan/setup.h"
#include "model/run/reference_kind.h"

namespace cuboct {

// The engine that runs the scene where nobody names one.
std::string engine_for(const Scene& scene);
// InputError, at the key that asks for more, where the engine cannot run the scene.
void check_runs(const Scene& scene, const Arch& arch, const std::string& engine);

// plan_of, or what stands for a plan (hw/plan/real_plan.h): of rules of several rounds, and of rules of pairs
// that no integers hold, where `engine` always computes in doubles. None is named: engine_for(scene). `real`:
// the engine is to compute in real numbers, so that a rule of text needs no integers.
Plan scene_plan_of(const Scene& scene, const Arch& arch, const std::string& engine = "", bool real = false);
// The plan and the initial state of a machine, of the pair law or of a rule of text. Throws InputError where
// the scene has none.
Setup machine_setup(const Scene& scene, const Arch& arch);
// Of several engines that share a plan, the one that takes the fewest shapes of cells.
const std::string& strictest(const std::vector<std::string>& engines);
// The same for several engines that hold the same bits: each must run the scene.
Plan shared_plan_of(const Scene& scene, const Arch& arch, const std::vector<std::string>& engines);
// Those that a crosscheck compares where nobody names any.
std::vector<std::string> engines_to_cross(const Scene& scene, const Arch& arch);

// Of steps or an interval, as the scene can do them: static loading knows whole load steps.
uint64_t whole_steps(const Scene& scene, uint64_t steps);

// As of model/run/reference_kind.h, with the hash of a plan and its nodes.
EngineKind scene_reference_kind(const Scene& scene, const Plan& plan, const RealOptions& options);

}  // namespace cuboct
