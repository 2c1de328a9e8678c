// SPDX-License-Identifier: MIT
// Every operation of a graph in vectors beside plain integers.
#include "emu/lattice/rounds/vector_block.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/graph/random_graph.h"

namespace cuboct::test {
namespace {

// Of each graph the nodes before the first that doubles do not hold.
TEST(VectorBlock, MakesTheNumbersOfPlainIntegers) {
  std::map<graph::Op, int> met;
  int faults = 0;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    const graph::Graph graph = random_graph(seed, 40).graph;
    const graph::Exactness exact = graph::exactness_of(graph);
    std::vector<int> nodes(exact.doubles ? graph.nodes.size() : static_cast<size_t>(exact.worst));
    std::iota(nodes.begin(), nodes.end(), 0);
    constexpr size_t kLanes = 61;
    graph::Block<int64_t> plain(graph, kLanes);
    emu::VectorBlock vectors(graph, {nodes}, nodes);
    Dice dice(seed);
    for (const int n : nodes) {
      const graph::Node& node = graph.nodes[static_cast<size_t>(n)];
      if (node.op != graph::Op::input) continue;
      for (size_t k = 0; k < kLanes; ++k) plain.values(n)[k] = random_value(dice, node.range);
      for (size_t k = 0; k < emu::VectorBlock::padded(kLanes); ++k)
        vectors.values(n)[k] = static_cast<double>(plain.values(n)[k < kLanes ? k : 0]);
    }
    plain.run(nodes, kLanes);
    const bool fits = vectors.run(0, kLanes);
    ASSERT_EQ(fits, plain.faults().empty()) << "seed " << seed;
    faults += !fits;
    for (const int n : nodes) {
      const graph::Node& node = graph.nodes[static_cast<size_t>(n)];
      ++met[node.op];
      for (size_t k = 0; k < kLanes; ++k)
        ASSERT_EQ(static_cast<double>(plain.values(n)[k]), vectors.values(n)[k])
            << "seed " << seed << ", " << to_string(node.op) << " " << n << ", lane " << k;
    }
  }
  for (int op = 0; op <= static_cast<int>(graph::Op::noise); ++op)
    EXPECT_GT(met[static_cast<graph::Op>(op)], 50) << to_string(static_cast<graph::Op>(op));
  EXPECT_GT(faults, 20);
}

// A place is given to another node once nobody reads its lanes.
TEST(VectorBlock, OutputsOutliveTheNodesBetween) {
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const graph::Graph graph = random_graph(seed, 60).graph;
    if (!graph::exactness_of(graph).doubles) continue;
    const auto last = static_cast<int>(graph.nodes.size()) - 1;
    const std::vector<int> outputs{last / 2, last};
    const std::vector<int> nodes = needed_by(graph, outputs);
    std::vector<int> all(graph.nodes.size());
    std::iota(all.begin(), all.end(), 0);
    emu::VectorBlock some(graph, {nodes}, outputs), every(graph, {all}, all);
    Dice dice(seed);
    for (const int n : all) {
      const graph::Node& node = graph.nodes[static_cast<size_t>(n)];
      if (node.op != graph::Op::input) continue;
      for (size_t k = 0; k < 8; ++k) every.values(n)[k] = static_cast<double>(random_value(dice, node.range));
      if (some.values(n) != nullptr) std::copy_n(every.values(n), 8, some.values(n));
    }
    every.run(0, 8);
    for (int lap = 0; lap < 2; ++lap) {
      some.run(0, 8);
      for (const int n : outputs)
        for (size_t k = 0; k < 8; ++k) ASSERT_EQ(some.values(n)[k], every.values(n)[k]) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace cuboct::test
