// SPDX-License-Identifier: MIT
// Whether what a rule calls a broken bond never counts again.
#pragma once

#include "model/program/rule_program.h"

namespace cuboct {

// Proven over truths: `broken` reads truths of bonds alone; wherever it holds, each sum's `when` is false
// whatever else there is, and no round changes those truths. False: there is no `broken`, or no proof.
bool broken_for_ever(const RuleProgram& rule);

}  // namespace cuboct
