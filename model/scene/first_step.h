// SPDX-License-Identifier: MIT
// Steps of a rule of text count on where a run goes on from another, so that no noise comes twice.
#pragma once

#include <cstdint>

#include "model/contract/rule.h"

namespace cuboct {

// How many steps went before the run; 0 where the rule is no text.
uint64_t first_step_of(const Rule& rule);
// Makes it so many, where the rule is text.
void begin_at_step(Rule& rule, uint64_t step);

}  // namespace cuboct
