// SPDX-License-Identifier: MIT
// A rule's text in integers: its graphs, whose values count in steps and cell edges, as golden runs them.
//
// Formats. A field has 46 bits over its range; a factor 26, a product 52; a sum what its partners leave
// of 51. What depends on r alone is one table of octaves. A constant factor changes the unit of a value and
// costs nothing. docs/reference/graph.md.
#pragma once

#include <string>
#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/graph/program.h"
#include "model/program/integers.h"
#include "model/program/rule_program.h"

namespace cuboct {

// Of a particle field: real = (unit times 2^-frac) * integer.
struct FieldScale {
  double unit = 1;
  int frac = 0;
};

struct IntegerProgram {
  graph::FixedProgram program;
  std::vector<FieldScale> scales;  // of program.fields
  // The field of RuleProgram::particle that each is.
  std::vector<size_t> field;
  std::vector<std::vector<Integers::Fit>> tables;  // by round, of its pair terms and its finish
};

// `base`: formats, cell edge, step, masses and constraints of the scene. `start`: by number of the rule's
// particle fields, by particle: what they begin with, which gives the range of those that never change.
// InputError, about the rule, where integers cannot do what it says.
IntegerProgram integer_program(const RuleProgram& rule, const FixedRule& base, int capacity,
                               const std::vector<std::vector<double>>& start);

}  // namespace cuboct
