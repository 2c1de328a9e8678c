// SPDX-License-Identifier: MIT
// Random graphs over all operations, compiled for vectors, beside the interpreter.
#include <gtest/gtest.h>

#include <map>

#include "emu/lattice/code/proof.h"
#include "tests/graph/random_graph.h"

namespace cuboct::test {
namespace {

// Its inputs become fields of the program, of this end. The graph ends before the first node that doubles do
// not hold. `met`: counts operations.
graph::Graph graph_of_fields(graph::FixedProgram& program, uint64_t seed, graph::Source end,
                             std::map<graph::Op, int>& met) {
  graph::Graph graph = random_graph(seed, 40).graph;
  const graph::Exactness exact = graph::exactness_of(graph);
  if (!exact.doubles) graph.nodes.resize(static_cast<size_t>(exact.worst));
  for (graph::Node& node : graph.nodes) {
    ++met[node.op];
    if (node.op != graph::Op::input) continue;
    node.source = end, node.index = static_cast<int>(program.fields.size()), node.axis = 0;
    program.fields.push_back({.name = "f", .numbers = 1, .range = node.range});
  }
  return graph;
}

// The pairs' graph reads the other particle, and what it makes is summed. What the finish makes is written.
void add_round(graph::FixedProgram& program, uint64_t seed, std::map<graph::Op, int>& met) {
  graph::Round round{.name = std::to_string(seed),
                     .pair = graph_of_fields(program, seed, graph::Source::other_field, met),
                     .finish = graph_of_fields(program, seed + 1'000'000, graph::Source::own_field, met)};
  constexpr graph::Interval kSummed{-(int64_t{1} << 46), int64_t{1} << 46};  // of 27 partners below 2^51
  const int nodes = static_cast<int>(round.pair.nodes.size());
  for (int n = 0; n < nodes; ++n) {
    const graph::Node& node = round.pair.nodes[static_cast<size_t>(n)];
    if (kSummed.holds(node.range.low) && kSummed.holds(node.range.high)) round.sums.push_back({"s", {n}});
  }
  round.pair.nodes.push_back({.op = graph::Op::constant, .number = 1, .range = {1, 1}});
  round.when = nodes;
  for (int n = 0; n < static_cast<int>(round.finish.nodes.size()); ++n) {
    round.writes.push_back({.field = static_cast<int>(program.fields.size()), .component = 0, .node = n});
    program.fields.push_back({.name = "made"});
  }
  program.rounds.push_back(std::move(round));
}

void compare_graphs(uint64_t first, uint64_t count, std::map<graph::Op, int>& met) {
  graph::FixedProgram program;
  program.position_frac = 12;
  for (uint64_t seed = first; seed < first + count; ++seed) add_round(program, seed, met);
  const emu::CodeLibrary library(program, false, "", testing::TempDir() + "cuboct_rule_code_graphs");
  const emu::BondSpace space;
  emu::KernelRule rule;
  rule.cell = 4096, rule.inverse_cell = 1.0 / 4096, rule.guard = rule.inverse_guard = 1;
  const std::vector<double> constants;
  const emu::RoundCode code{program, rule, space, false, constants, &library};
  for (size_t k = 0; k < program.rounds.size(); ++k)
    EXPECT_NO_THROW(emu::prove(code, k)) << "seed " << first + k;
}

TEST(RuleCodeGraphs, EqualTheInterpreter) {
  std::map<graph::Op, int> met;
  compare_graphs(1, 8, met);
  for (int op = 0; op <= static_cast<int>(graph::Op::noise); ++op)
    EXPECT_GT(met[static_cast<graph::Op>(op)], 0) << to_string(static_cast<graph::Op>(op));
}

// Of the full tier.
TEST(RuleCodeGraphsMore, EqualTheInterpreter) {
  std::map<graph::Op, int> met;
  for (uint64_t first = 1000; first < 1480; first += 24) compare_graphs(first, 24, met);
  EXPECT_GT(met[graph::Op::lookup], 400);
}

}  // namespace
}  // namespace cuboct::test
