// SPDX-License-Identifier: MIT
// A rule's text as a pair law: one round, whose force is a function of r along d.
#pragma once

#include <memory>

#include "model/contract/rule.h"
#include "model/program/rule_program.h"

namespace cuboct {

// Of a text with `core`. The force of the law at r is what the text gives for d = (r, 0, 0). Where it is a
// table's value at r the law has the table's pieces, else it is asked.
// InputError, with its place, where the text does more than a pair law, or where its energy is not the
// force's.
std::shared_ptr<const PairLaw> formula_law(const RuleText& text, std::shared_ptr<const RuleProgram> program);

}  // namespace cuboct
