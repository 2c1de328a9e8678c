// SPDX-License-Identifier: MIT
// Many printed pipelines in one Verilated model, driven back to back and compared with the interpreter.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hw/pipeline/print.h"
#include "model/graph/graph.h"

namespace cuboct::test {

struct Pipeline {
  std::string name;
  graph::Graph graph;
  pipeline::Outputs outputs;
  int when = -1;  // a node: outputs that take it for granted count where it holds
  pipeline::Schedule schedule;
};
// Every node's value but constants' is an output.
Pipeline all_of(const std::string& name, graph::Graph graph, int when);
// Of the graph of a pair, and of a finish.
Pipeline pair_of(const std::string& name, const graph::Round& round);
Pipeline finish_of(const std::string& name, const graph::FixedProgram& program, const graph::Round& round);

// Whether nodes are any where the pair does not count.
std::vector<bool> taken_for_granted(const graph::Graph& graph);

// What was compared.
struct Compared {
  uint64_t sets = 0, values = 0, faults = 0, counting = 0;
  std::map<graph::Op, uint64_t> by_op;  // values
};
struct Difference {
  std::string what;  // empty: none
};

enum class Form : uint8_t { printed, gates };  // as printed; the gates that yosys makes of it

// Compiles them as one model, and drives each with so many sets of inputs. Each pipeline has a difference,
// the first, in their order.
Compared compare(const std::vector<Pipeline>& pipelines, size_t sets, uint64_t seed,
                 std::vector<Difference>& differences, Form form = Form::printed);

}  // namespace cuboct::test
