// SPDX-License-Identifier: MIT
// Where the values of a graph live while it runs: a place each, for as long as somebody reads it.
#pragma once

#include <vector>

#include "model/graph/graph.h"

namespace cuboct::graph {

struct Registers {
  std::vector<int> of;  // by node; -1: it is not run
  int count = 0;
};

// `parts`: nodes, in the order of the graph, that are run one part after the other. Constants and inputs have
// a register of their own; outputs keep theirs. In parts after the first all pairs count, so `within` has
// that of its input. `sizes`, where given: by node, how many registers in a row its value takes, `of` names
// the first of them.
Registers registers_for(const Graph& graph, const std::vector<std::vector<int>>& parts,
                        const std::vector<int>& outputs, const std::vector<int>& sizes = {});

// Whether an engine computes the node, rather than to fill in its value.
inline bool is_computed(const Node& node) { return node.op != Op::constant && node.op != Op::input; }

}  // namespace cuboct::graph
