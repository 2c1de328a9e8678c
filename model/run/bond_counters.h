// SPDX-License-Identifier: MIT
// What the engines of a rule of several rounds count of its bonds.
#pragma once

#include "model/rules/rounds_rule.h"
#include "model/run/engine.h"

namespace cuboct {

// "bonds" and, where bonds can be damaged, "mean_damage" and "largest_damage" of `particles`.
Counters bond_counters(const Rule& rule, const RoundsTerms& terms, size_t particles);

}  // namespace cuboct
