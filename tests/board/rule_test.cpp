// SPDX-License-Identifier: MIT
// Machines of rules of text behind a host's link, Verilated: golden's bits, fields, bonds and faults, and the
// native nodes' cycles.
#include <gtest/gtest.h>

#include <functional>

#include "emu/board/session.h"
#include "emu/machine/collector.h"
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

// A run that is looked at after each step, and one that is read at its end alone.
void expect_golden(const Case& c, const BoardChoice& choice, uint64_t steps,
                   const std::function<void(emu::Host&)>& after = {}) {
  SimulatedBoard machine(c.setup, choice);
  emu::Host host(machine.port(), SimulatedBoard::kBaud, kRuleTimeout);
  const Trace golden = golden_trace(c.setup, steps);
  const Trace each = run(host, c, {.steps = steps});
  EXPECT_EQ(difference(c.setup.plan, golden, each), "");
  EXPECT_EQ(each.state_hash, golden.state_hash);
  const Trace whole = run(host, c, {.steps = steps, .frames = {steps}, .hash_every = golden.steps()});
  ASSERT_EQ(whole.stop.has_value(), golden.stop.has_value());
  if (golden.stop) {
    EXPECT_EQ(*whole.stop, *golden.stop);
  } else {
    EXPECT_EQ(whole.state_hash.back(), golden.state_hash.back());
  }
  EXPECT_EQ(host.count().retries, 0u);
  if (after) after(host);
}

// Three rounds with fields. In the sixth step the last round's pairs fail in both nodes, and the first
// round's finish on the right of the second one: what is found in the earlier round counts, though another
// node finds a lesser id later.
TEST(RuleBoard, FindsTheFaultOfTheEarlierRound) {
  const auto strong = [](const std::string& rule) { return replaced(rule, "1e7 N", "1e8 N"); };
  const std::string right = replaced(strong(failing(true, true)), "a + 1.9", "a + 2.3");
  const Case c = case_of("small", small(right), {}, 9);
  ASSERT_EQ(c.setup.plan.nodes(), 2u);
  const auto found = golden_trace(c.setup, 9).stop;
  ASSERT_TRUE(found);
  ASSERT_EQ(found->cell, 1u);
  expect_golden(c, behind("axi4lite"), 9, [&](emu::Host& host) {
    // The first node's own fault: of the last round, and of a lesser id.
    const emu::BoardFault other = host.fault(0);
    const int id_bits = c.setup.plan.words.id_bits;
    EXPECT_EQ(other.fault, found->fault);
    EXPECT_LT(other.particle & ((1U << id_bits) - 1), found->particle);
    EXPECT_GT(other.particle >> id_bits, host.fault(1).particle >> id_bits);
  });
}

TEST(RuleBoard, HoldsGoldensBitsFieldsAndCycles) {
  const Case c = case_of("small", small(kTwoRounds), {}, 9);
  const BoardChoice choice{.name = "ulx3s", .baud = 3000000};
  expect_golden(c, choice, 9);
  SimulatedBoard machine(c.setup, choice);
  emu::Host host(machine.port(), SimulatedBoard::kBaud, kRuleTimeout);
  const auto nodes = emu::by_node(c.setup.plan, c.setup.initial);
  uint16_t index = 0;
  for (uint16_t n = 0; n < nodes.size(); ++n)
    for (const emu::Loaded& p : nodes[n]) host.load(index++, n, p.word, c.setup.plan.words.particle_bits);
  host.run(0, 9);
  while (host.status().busy) continue;
  EXPECT_EQ(host.status().cycles, cycles_of(c.setup, 9));
}

// A bond breaks where the moved end tears; rows come and go with their particles' words.
TEST(RuleBoard, HoldsBondsThatBreak) {
  const Case c = case_of("bonds", small(R"toml(bonds = "reference"
reach = "1.2 * pitch"
stiffness = "8 kN/m"
broken = "not whole"
[rule.bond.whole]
kind = "truth"
start = "true"
[[rule.round]]
bond.whole = "whole and dot(d, d) < 1.02 * pitch^2"
sum.force = { is = "0.5 kN/m * d * (1 - pitch^2 / dot(d, d))", when = "whole" }
)toml"),
                         {}, 9);
  const Trace golden = golden_trace(c.setup, 9);
  ASSERT_FALSE(golden.frames.back().bonds.empty());
  ASSERT_NE(golden.frames[1].bonds, golden.frames.back().bonds);
  expect_golden(c, behind("wishbone"), 9);
}

// Killed, as far as files can tell, between a checkpoint and the next.
TEST(RuleBoard, GoesOnFromACheckpoint) {
  const Case c = case_of("small", small(kTwoRounds), {}, 9);
  SimulatedBoard machine(c.setup, {.name = "ulx3s", .baud = 3000000});
  emu::Host host(machine.port(), SimulatedBoard::kBaud, kRuleTimeout);
  const EngineKind kind = emu::board_kind(host, c.scene, c.setup.plan);
  const Scratch scratch;
  RunRequest request;
  request.steps = 9;
  request.frames = {0, 7, 9};
  request.hash_every = 1;
  request.checkpoint.path = scratch.path("checkpoint");
  request.checkpoint.every_steps = 3;
  struct Killed {};
  uint64_t kept = 0;
  request.keep = [&](const RunState&) {
    if (++kept == 2) throw Killed();
  };
  EXPECT_THROW(record(c.scene, kind, request), Killed);
  request.keep = {};
  request.checkpoint.resume = true;
  const Recorded resumed = record(c.scene, kind, request);
  EXPECT_EQ(resumed.resumed_at, 6u);
  EXPECT_EQ(resumed.trace.state_hash, golden_trace(c.setup, 9).state_hash);
  EXPECT_GT(resumed.trace.counters.front().second, static_cast<double>(cycles_of(c.setup, 6)));
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
