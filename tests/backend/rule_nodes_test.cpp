// SPDX-License-Identifier: MIT
// Rules of text on the clocked nodes: golden's bits, order and faults, and the timing model's cycles.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "emu/systemc/node.h"
#include "model/program/integer_program.h"
#include "tests/backend/clocked_timing.h"
#include "tests/backend/engines.h"
#include "tests/backend/rule_cases.h"

namespace cuboct::test {
namespace {

class RuleNodes : public testing::TestWithParam<const char*> {
 protected:
  std::string text() const {
    const std::string name = GetParam();
    return name == "one" ? hot(kOneRound) : hot(kFourRounds);
  }
};

TEST_P(RuleNodes, HoldGoldensBitsAndTheModelsCycles) {
  Seen seen;
  uint64_t slots = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    const Case c = case_of(fmt::format("{} {}", GetParam(), seed), text(), drawn(seed), 7);
    ASSERT_EQ(difference(c, seen), "") << c.name;
    const auto run =
        run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps, seed % 2 == 0 ? 0.3 : 0, seed),
                       emu::native_nodes(c.setup.plan), "plain");
    const Compared compared = compare(c.setup.plan, run_golden(c.setup, c.steps), run);
    EXPECT_EQ(compared.difference, "") << c.name;
    slots += compared.slots;
  }
  EXPECT_EQ(seen.runs, 6u);
  EXPECT_GT(slots, 5000u);
  EXPECT_GT(seen.leave, 50u);
  EXPECT_GT(seen.leave_twice, 3u);
  EXPECT_GT(seen.multi_pass, 0u);
  EXPECT_GT(seen.multi_beat, 0u);
  EXPECT_GT(seen.stalls, 0u);
  EXPECT_GT(seen.boards, 0u);
  EXPECT_GT(seen.checked, 0u);
  EXPECT_GT(seen.no_overlap, 0u);
}
INSTANTIATE_TEST_SUITE_P(Rules, RuleNodes, testing::Values("one", "four"),
                         [](const auto& p) { return std::string(p.param); });

// What later rounds send: what a round reads of the other and nobody sent before, or a finish changed since.
TEST(RuleRecords, HoldWhatTheRoundReadsAnew) {
  const Case c = case_of("four", hot(kFourRounds), {}, 1);
  const graph::FixedProgram& program = c.setup.plan.program->program;
  const auto sent = [&](size_t round) {
    std::vector<std::string> names;
    for (const WordField& field : c.setup.plan.rounds.at(round).record)
      if (field.kind == FieldKind::field) {
        int f = 0;
        while (f + 1 < static_cast<int>(program.fields.size()) && program.place(f + 1) <= field.number) ++f;
        names.push_back(program.fields[static_cast<size_t>(f)].name);
      }
    return names;
  };
  ASSERT_EQ(c.setup.plan.rounds.size(), 4u);
  EXPECT_EQ(sent(0), std::vector<std::string>());
  EXPECT_EQ(sent(1), std::vector<std::string>{"crowd"});
  EXPECT_EQ(sent(2), std::vector<std::string>());
  EXPECT_EQ(c.setup.plan.rounds[2].beats, 0);
  EXPECT_EQ(sent(3), (std::vector<std::string>{"way", "way", "way", "memory"}));
}

TEST(RuleNodeFaults, AreGoldens) {
  uint32_t left = 0, right = 0;  // who is told where one thing fails, and where both do
  for (const auto& [grows, pushes] : {std::pair{true, false}, {false, true}, {true, true}})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      const Case c = case_of(fmt::format("fails {} {} {}", grows, pushes, seed), hot(failing(grows, pushes)),
                             drawn(seed), 9);
      const GoldenRun golden = run_golden(c.setup, c.steps);
      ASSERT_TRUE(golden.fault) << c.name;
      EXPECT_EQ(golden.fault->step, 5u) << c.name;
      (grows ? right : left) = golden.fault->particle;
      const auto run = run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps, seed == 2 ? 0.2 : 0),
                                      emu::native_nodes(c.setup.plan), "plain");
      EXPECT_EQ(compare(c.setup.plan, golden, run).difference, "") << c.name;
    }
  EXPECT_LT(left, right);
}

}  // namespace
}  // namespace cuboct::test
