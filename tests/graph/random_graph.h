// SPDX-License-Identifier: MIT
// Graphs drawn at random over all operations, and lanes at the ends of intervals, ties and seams.
#pragma once

#include <map>

#include "model/graph/builder.h"
#include "model/graph/interpret.h"
#include "tests/support/dice.h"

namespace cuboct::test {

// A table with any entries.
FixedTable random_table(Dice& dice);

struct Drawn {
  graph::Graph graph;
  std::map<graph::Op, int> refused;  // operations that left their room
  int when;                          // the truth that `within` counts on
};
// `steps` operations over a few inputs; with a pair's truth in the middle.
Drawn random_graph(uint64_t seed, int steps);

// Over two fields of own and other and what is between them, without checks.
graph::Graph random_pair_graph(uint64_t seed, int steps);

// Values of an input: its ends, zero, ties of roundings, seams of tables, any.
int64_t random_value(Dice& dice, graph::Interval range);

// Fills all inputs of a block, and runs all nodes.
template <class Int>
void run_all(graph::Block<Int>& block, const graph::Graph& graph, uint64_t seed, size_t lanes) {
  Dice dice(seed);
  std::vector<int> all;
  for (int n = 0; n < static_cast<int>(graph.nodes.size()); ++n) {
    all.push_back(n);
    const graph::Node& node = graph.nodes[static_cast<size_t>(n)];
    if (node.op == graph::Op::input)
      for (size_t k = 0; k < lanes; ++k) block.values(n)[k] = random_value(dice, node.range);
  }
  block.run(all, lanes);
}

}  // namespace cuboct::test
