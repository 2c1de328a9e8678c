// SPDX-License-Identifier: MIT
// What a scene becomes, for people: the plan of its machine, or its rule where none is built.
#pragma once

#include <string>

#include "cli/command.h"
#include "cli/items.h"

namespace cuboct {

// Whether it is a plan, and not what stands for one.
inline bool has_machine(const Plan& plan) { return plan.lattice.size() > 0; }
// Of a rule of pairs without one.
inline constexpr const char* kNoFormats = "none: no integers hold the rule, doubles compute it";

// The plan as text, or the rule's settings and rounds.
std::string plan_text(const Loaded& loaded);
// The latter as items; nothing for a scene of pairs.
void add_rounds(Items& items, const Scene& scene);

}  // namespace cuboct
