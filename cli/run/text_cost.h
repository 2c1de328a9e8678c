// SPDX-License-Identifier: MIT
// What a step of a rule of text takes the reference engine, by the operations of its graphs.
#pragma once

#include "model/program/rule_program.h"

namespace cuboct {

struct TextCost {
  double neighbour = 0;  // s, of a particle and one neighbour
  double particle = 0;   // s, of a particle beside its neighbours
};

// On one core of an EPYC.
TextCost text_cost(const RuleProgram& program);

}  // namespace cuboct
