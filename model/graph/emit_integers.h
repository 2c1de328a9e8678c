// SPDX-License-Identifier: MIT
// A graph as C++: a statement for each node, over the functions of integer_ops.h, with golden's values
// (interpret.h). A value has 32 bits where its interval fits them, else 64. So has a product: of two factors
// of 32 bits it is product() (model/base/fixed_math.h), one instruction where a machine has it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/graph/graph.h"

namespace cuboct::graph {

// Expressions for what stands outside of a graph.
struct Outside {
  std::function<std::string(const Node& input)> input;
  // `argument`: of type uint64_t; `law`: of any integer type.
  std::function<std::string(const Node& lookup, const std::string& argument, const std::string& law)> lookup;
};

// "int32_t" or "int64_t".
const char* type_text(const Node& node);
// What stands for the node in an expression: "n12", or a constant's number.
std::string value_text(const Graph& graph, int node);

// A line for each of these nodes but constants and those that `given` has, in the order of the list. A check
// that finds what does not fit sets `fits`, a bool, to false. `all_count`: pairs count, so that `within` is
// its input.
std::string statements(const Graph& graph, const std::vector<int>& nodes, const Outside& outside,
                       bool all_count = false);

}  // namespace cuboct::graph
