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

// `parts`: nodes, in an order in which inputs stand before those who use them, that are run one part after
// the other. Constants and inputs have a register of their own; outputs keep theirs. In parts after the first
// all pairs count, so `within` has that of its input.
Registers registers_for(const Graph& graph, const std::vector<std::vector<int>>& parts,
                        const std::vector<int>& outputs);

// As above, of values that take one register or two in a row, by node in `sizes`; `of` names the first. Where
// it is 0 a node has none. An input is read at the beginning of its part, and has its registers from there on
// until it is used last.
Registers registers_for(const Graph& graph, const std::vector<std::vector<int>>& parts,
                        const std::vector<int>& outputs, const std::vector<int>& sizes);

// Whether an engine computes the node, rather than to fill in its value.
inline bool is_computed(const Node& node) { return node.op != Op::constant && node.op != Op::input; }

}  // namespace cuboct::graph
