// SPDX-License-Identifier: MIT
// Scenes for the commands that need no machine: those of pairs with their plan, and those whose rule has
// several rounds, for which none is built.
#pragma once

#include <string>

#include "cli/command.h"
#include "cli/items.h"

namespace cuboct {

// As load_plan, or with what stands for a plan (hw/plan/real_plan.h): of rules of several rounds, and of
// rules of pairs that no integers hold, where `engine` always computes in doubles. None is named: the one
// that the scene asks for. `real` as of scene_plan_of.
Loaded load_any(const Input& input, const std::string& engine = "", bool real = false);

// Whether it is a plan, and not what stands for one.
inline bool has_machine(const Plan& plan) { return plan.lattice.size() > 0; }
// Of a rule of pairs without one.
inline constexpr const char* kNoFormats = "none: no integers hold the rule, doubles compute it";

// The plan as text, or the rule's settings and rounds.
std::string plan_text(const Loaded& loaded);
// The latter as items; nothing for a scene of pairs.
void add_rounds(Items& items, const Scene& scene);

}  // namespace cuboct
