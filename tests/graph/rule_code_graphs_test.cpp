// SPDX-License-Identifier: MIT
// Random graphs over all operations, compiled for vectors, beside the interpreter.
#include <gtest/gtest.h>

#include <map>

#include "emu/lattice/code/proof.h"
#include "tests/graph/random_graph.h"

namespace cuboct::test {
namespace {

// Each graph is that of a round's pairs, its inputs fields of the other particle; what it makes is summed.
void add_round(graph::FixedProgram& program, uint64_t seed, std::map<graph::Op, int>& met) {
  graph::Round round{.name = std::to_string(seed), .pair = random_graph(seed, 40).graph};
  graph::Graph& pair = round.pair;
  const graph::Exactness exact = graph::exactness_of(pair);
  if (!exact.doubles) pair.nodes.resize(static_cast<size_t>(exact.worst));
  constexpr graph::Interval kSummed{-(int64_t{1} << 46), int64_t{1} << 46};  // of 27 partners below 2^51
  const int nodes = static_cast<int>(pair.nodes.size());
  for (int n = 0; n < nodes; ++n) {
    graph::Node& node = pair.nodes[static_cast<size_t>(n)];
    ++met[node.op];
    if (node.op == graph::Op::input) {
      node.source = graph::Source::other_field;
      node.index = static_cast<int>(program.fields.size()), node.axis = 0;
      program.fields.push_back({.name = "f", .numbers = 1, .range = node.range});
    }
    if (kSummed.holds(node.range.low) && kSummed.holds(node.range.high)) round.sums.push_back({"s", {n}});
  }
  pair.nodes.push_back({.op = graph::Op::constant, .number = 1, .range = {1, 1}});
  round.when = nodes;
  program.rounds.push_back(std::move(round));
}

void compare_graphs(uint64_t first, uint64_t count, std::map<graph::Op, int>& met) {
  graph::FixedProgram program;
  program.position_frac = 12;
  for (uint64_t seed = first; seed < first + count; ++seed) add_round(program, seed, met);
  const emu::CodeLibrary library(program, false, "", testing::TempDir() + "cuboct_rule_code_graphs");
  const emu::BondSpace space;
  for (size_t k = 0; k < program.rounds.size(); ++k) {
    const emu::CodePass code(library, program, space, k, false);
    emu::PairPass pass(program, program.rounds[k], space, false);
    EXPECT_NO_THROW(emu::prove(code, pass, program, program.rounds[k], space, false)) << "seed " << first + k;
  }
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
