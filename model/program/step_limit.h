// SPDX-License-Identifier: MIT
// The largest stable time step of a rule of text that does not say its stiffness: by what its forces and
// fields answer to small changes of the start.
#pragma once

#include <string>

#include "model/contract/rule.h"
#include "model/program/rule_program.h"

namespace cuboct {

struct StepLimit {
  double dt = 0;        // s; 0: none is known
  std::string of;       // what sets it: "the rule's forces at the start"
  std::string unknown;  // why none is known
};

// `program` is the rule's text. With -K the change of forces with positions and -C that with velocities, the
// limit is that of stable_time_step (model/scene/scene_parts.h) with the largest eigenvalues of K/m and C/m;
// where a round makes fields with dt, T' = T - dt R T to first order, it is 2 over the largest one of R as
// well. Each is a power iteration by central differences, from below: a band of waves ends a few per cent
// above it. Of large bodies a part is looked at, in the middle of each type's particles.
StepLimit step_limit(const RuleProgram& program, const Rule& rule, const Body& body,
                     const Periodic& periodic);

}  // namespace cuboct
