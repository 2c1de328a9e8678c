// SPDX-License-Identifier: MIT
// When each step of a graph is done, in a pipeline that takes a set of inputs in every cycle. A schedule is a
// function of the graph and the delays alone: its cycles are a contract.
#pragma once

#include <vector>

#include "hw/pipeline/delays.h"
#include "hw/pipeline/steps.h"
#include "model/graph/program.h"

namespace cuboct::pipeline {

// A value is there `ps` after the registers of `cycle` are. All inputs stand in registers in cycle 0.
struct Moment {
  int cycle = 0, ps = 0;
  auto operator<=>(const Moment&) const = default;
};

struct Schedule {
  Steps steps;
  std::vector<Moment> at;  // by step: its result
  std::vector<int> ready;  // by node: the first cycle in whose registers its value may stand; -1: not needed
  int cycles = 0;          // in this one all outputs, and the fault of the checks, stand in registers
};

// As soon as possible: steps follow one another within a cycle while the clock's period has room for them.
// std::logic_error where one step alone has none.
Schedule schedule_of(const graph::Graph& graph, const std::vector<int>& outputs,
                     const Delays& delays = kDelays);

// What a pair's pipeline makes: the outputs of the round and, last, `when`.
std::vector<int> piped_outputs(const graph::Round& round);

}  // namespace cuboct::pipeline
