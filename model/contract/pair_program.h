// SPDX-License-Identifier: MIT
// The pair law as a program: docs/reference/numeric.md, node by node.
#pragma once

#include <string>
#include <vector>

#include "model/contract/fixed_rule.h"
#include "model/graph/builder.h"
#include "model/graph/program.h"

namespace cuboct {

// For cells of so many particles. It makes of each pair what pair_kick makes, and of each particle what
// finish makes, faults included.
graph::FixedProgram pair_program(const FixedRule& rule, int capacity);

// A program of this rule's formats and types for cells of so many particles, without fields and rounds.
graph::FixedProgram begun_program(const std::string& name, const FixedRule& rule, int capacity);

// A relative velocity along an axis in edges of the longest, and a difference. Beyond the cutoff the latter
// is cut off at 5/4 of an edge, so that doubles hold r2 whatever D is.
int shaped(graph::Builder& builder, const FixedRule& rule, int axis, int node);
int shaped_difference(graph::Builder& builder, const FixedRule& rule, int axis, int node);

// The last finish of any program: what kicks, constraints and gravity make of a particle's velocity, place
// and displacement. `kicks`: nodes of `builder`, by axis, P+G fractional bits, of the lightest material.
void add_motion(graph::Builder& builder, graph::FixedProgram& program, const FixedRule& rule,
                const std::vector<int>& kicks);

}  // namespace cuboct
