// SPDX-License-Identifier: MIT
// A rule's text in integers: its graphs, whose values count in steps and cell edges, as golden runs them.
//
// Formats. A field has 46 bits over its range; a factor 26, a product 52; a sum what its partners leave
// of 51. What depends on r alone is one table of octaves; of bonds that last one of a window around each
// length that they have in the body as packed. A constant factor changes the unit of a value and costs
// nothing. docs/reference/graph.md.
#pragma once

#include <memory>
#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/graph/bond_rows.h"
#include "model/graph/program.h"
#include "model/program/integers.h"
#include "model/program/program_start.h"
#include "model/program/rule_program.h"

namespace cuboct {

// Of a field: real = (unit times 2^-frac) * integer.
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

  // Of a rule whose bonds are those of the body as packed; else none.
  std::shared_ptr<const graph::BondRows> rows;
  std::vector<FieldScale> bond_scales;  // of program.bonds
  std::vector<size_t> bond_field;       // the field of RuleProgram::bond that each is
  size_t lengths = 0;                   // of bonds in the body as packed
};

// `base`: formats, cell edge, step, masses and constraints of the scene. `start`: what the rule's fields
// begin with, which gives the range of those that never change. InputError, about the rule, where integers
// cannot do what it says.
IntegerProgram integer_program(const RuleProgram& rule, const FixedRule& base, int capacity,
                               const ProgramStart& start);

// State::bonds of these fields: both ends of a bond hold what the end with the lesser id has.
std::vector<int64_t> bond_numbers(const IntegerProgram& program, const RuleProgram& rule,
                                  const ProgramStart& start);

}  // namespace cuboct
