// SPDX-License-Identifier: MIT
// A schedule as SystemVerilog. docs/reference/pipeline.md has the contract of the printed module's ports.
#pragma once

#include <string>
#include <vector>

#include "hw/pipeline/schedule.h"

namespace cuboct::pipeline {

// The nodes that a pipeline makes, and the names of its ports for them, without their `_o`.
struct Outputs {
  std::vector<int> nodes;
  std::vector<std::string> names;
};
// Of a pair: "sum_S_K" for component K of sum S, "bond_F_K" of what is written of the bond, "when".
Outputs pair_pipeline(const graph::Round& round);
// Of the finish: "field_F_K"; in the last round also "v_A", "u_A", "drift_A" by axis.
Outputs finish_pipeline(const graph::FixedProgram& program, const graph::Round& round);

struct Module {
  std::string name, text;  // of a file, without its .sv
};
// The module and its memories. They need cuboct_mult and cuboct_leading_zeros of the library.
// std::logic_error where the check refuses the schedule, or two outputs have one name.
std::vector<Module> print_pipeline(const std::string& name, const graph::Graph& graph, const Outputs& outputs,
                                   const Schedule& schedule, const Delays& delays = kDelays);

// Of any schedule: a step that comes too soon gets what stands there then. So a test sees what the check is
// for.
std::vector<Module> print_unchecked(const std::string& name, const graph::Graph& graph,
                                    const Outputs& outputs, const Schedule& schedule);

// The port of an input: "own_field_0_1_i" is component 1 of field 0.
std::string port_name(const graph::Node& input);

}  // namespace cuboct::pipeline
