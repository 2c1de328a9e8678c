// SPDX-License-Identifier: MIT
// Scenes for the commands that need no machine: those of pairs with their plan, and those whose rule has
// several rounds, for which none is built.
#pragma once

#include <string>

#include "cli/command.h"
#include "cli/items.h"

namespace cuboct {

// As load_plan, or with what stands for a plan (hw/real_plan.h).
Loaded load_any(const Input& input);

// The plan as text, or the rule's settings and rounds.
std::string plan_text(const Loaded& loaded);
// The latter as items; nothing for a scene of pairs.
void add_rounds(Items& items, const Scene& scene);

}  // namespace cuboct
