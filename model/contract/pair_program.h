// SPDX-License-Identifier: MIT
// The pair law as a program: docs/reference/numeric.md, node by node.
#pragma once

#include "model/contract/fixed_rule.h"
#include "model/graph/program.h"

namespace cuboct {

// For cells of so many particles. It makes of each pair what pair_kick makes, and of each particle what
// finish makes, faults included.
graph::FixedProgram pair_program(const FixedRule& rule, int capacity);

}  // namespace cuboct
