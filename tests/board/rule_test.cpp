// SPDX-License-Identifier: MIT
// Machines of rules of text behind a host's link, Verilated: golden's bits, fields, bonds and faults, and the
// native nodes' cycles.
#include <gtest/gtest.h>

#include "emu/board/session.h"
#include "hw/rtl/rtl_emit.h"
#include "tests/backend/bond_cases.h"
#include "tests/backend/rule_cases.h"
#include "tests/board/simulated_board.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

constexpr double kRuleTimeout = 20;  // s

// Eight particles in two nodes; what is left is held, what is right moved.
std::string small(const std::string& rule) {
  return "density = \"7.8 g/cm^3\"\npacking = { pitch = \"1 mm\", offset = \"[0.3, 0.3, 0.3] mm\" }\n"
         "run = { dt = \"0.2 us\", steps = 9 }\n[box]\ncells = [2, 1, 1]\n[reach]\nmargin = \"0.05 mm\"\n"
         "[[constraint]]\nname = \"left\"\nkind = \"held\"\n"
         "region = { shape = \"half_space\", point = \"[0.4, 0, 0] mm\", normal = \"x\" }\n"
         "[[constraint]]\nname = \"right\"\nkind = \"moved\"\nvelocity = \"[20, -10, 0] m/s\"\n"
         "region = { shape = \"half_space\", point = \"[2.4, 0, 0] mm\", normal = \"-x\" }\n"
         "[[velocity]]\nthermal_speed = \"10 m/s\"\nseed = 3\n[rule]\n" +
         rule;
}

Trace run(emu::Host& host, const Case& c, const BoardRun& run) {
  return run_on_board(host, {c.setup, c.scene}, run);
}

// All states, and a run that is read at its end alone.
void expect_golden(const Case& c, const BoardChoice& choice, uint64_t steps) {
  SimulatedBoard machine(c.setup, choice);
  emu::Host host(machine.port(), SimulatedBoard::kBaud, kRuleTimeout);
  const Trace golden = golden_trace(c.setup, steps);
  std::vector<uint64_t> all(steps + 1);
  std::iota(all.begin(), all.end(), uint64_t{0});
  const Trace each = run(host, c, {.steps = steps, .frames = all});
  EXPECT_EQ(difference(c.setup.plan, golden, each), "");
  const Trace whole = run(host, c, {.steps = steps, .frames = {0, steps}, .hash_every = 0});
  EXPECT_EQ(difference(c.setup.plan, golden, whole), "");
  ASSERT_EQ(whole.stop.has_value(), golden.stop.has_value());
  if (golden.stop) {
    EXPECT_EQ(*whole.stop, *golden.stop);
  } else {
    EXPECT_EQ(each.frames.size(), steps + 1);
    EXPECT_EQ(whole.counters.front().second, static_cast<double>(cycles_of(c.setup, steps)));
  }
  EXPECT_EQ(host.count().retries, 0u);
}

// Three rounds with fields. In the sixth step the first round's finish and the last round's pairs fail, and
// what is found in the earlier round counts.
TEST(RuleBoard, FindsTheFaultOfTheEarlierRound) {
  const Case c = case_of("small", small(failing(true, true)), {}, 9);
  ASSERT_LE(c.setup.plan.nodes(), 4u);
  ASSERT_TRUE(golden_trace(c.setup, 9).stop);
  expect_golden(c, behind("axi4lite"), 9);
}

TEST(RuleBoard, HoldsGoldensBitsFieldsAndCycles) {
  expect_golden(case_of("small", small(kTwoRounds), {}, 9), {.name = "ulx3s", .baud = 3000000}, 9);
}

TEST(RuleBoard, HoldsBondsThatBreak) {
  const BondedCase body(of_four(kSprings), {Vec3(900, 700, 500), 100, 0.02}, {}, 5);
  const Trace golden = golden_trace(body.c.setup, 5);
  ASSERT_NE(golden.frames.front().bonds, golden.frames.back().bonds);
  expect_golden(body.c, behind("wishbone"), 5);
}

// Nodes count steps from their reset.
TEST(RuleBoard, RefusesRulesThatReadTheStep) {
  const Case c = case_of("small", small(kFourRounds), {}, 9);
  EXPECT_EQ(
      refused_with([&] { check_emission(c.setup.plan, {.board = behind("wishbone")}); }),
      "--bus wishbone: the rule 'own' reads the step, which nodes count from their reset, and a host loads "
      "the state of any step\n  hint: emit the lattice without it: its ports take and show the rule's "
      "particles");
}

}  // namespace
}  // namespace cuboct::test
