// SPDX-License-Identifier: MIT
// Printed pipelines, Verilated, beside the interpreter: values, faults and cycles.
#include "hw/pipeline/print.h"

#include <gtest/gtest.h>

#include "tests/graph/random_graph.h"
#include "tests/pipeline/pipelines.h"
#include "tests/pipeline/rules.h"

namespace cuboct::test {
namespace {

using graph::Op;

Compared expect_equal(const std::vector<Pipeline>& pipelines, size_t sets) {
  std::vector<Difference> differences;
  const Compared compared = compare(pipelines, sets, 1, differences);
  for (const Difference& difference : differences) EXPECT_EQ(difference.what, "");
  EXPECT_GE(compared.sets, sets * pipelines.size());
  return compared;
}

std::vector<Pipeline> random_pipelines(uint64_t first, int count, int steps) {
  std::vector<Pipeline> all;
  for (uint64_t seed = first; seed < first + static_cast<uint64_t>(count); ++seed) {
    Drawn drawn = random_graph(seed, steps);
    all.push_back(all_of("random_" + std::to_string(seed), std::move(drawn.graph), drawn.when));
  }
  return all;
}

TEST(PrintedPipeline, OfRandomGraphsIsTheInterpreter) {
  const Compared compared = expect_equal(random_pipelines(1, 10, 40), 600);
  for (int op = static_cast<int>(Op::input); op <= static_cast<int>(Op::noise); ++op) {
    const auto found = compared.by_op.find(static_cast<Op>(op));
    EXPECT_GE(found == compared.by_op.end() ? 0 : found->second, 300u) << to_string(static_cast<Op>(op));
  }
  EXPECT_GT(compared.faults, 500u);
}

TEST(PrintedPipeline, OfRulesIsTheInterpreter) {
  std::vector<Pipeline> all;
  for (const char* rule : {"copper", "glass", "langevin"}) {
    const InIntegers made = shipped_rule(rule);
    for (const graph::Round& round : made.program.program.rounds) {
      all.push_back(pair_of(rule + round.name, round));
      all.push_back(finish_of(rule + round.name, made.program.program, round));
    }
  }
  const Compared compared = expect_equal(all, 600);
  EXPECT_GT(compared.counting, compared.sets / 2);
  EXPECT_LT(compared.counting, compared.sets);
  EXPECT_GT(compared.faults, 100u);
}

}  // namespace
}  // namespace cuboct::test
