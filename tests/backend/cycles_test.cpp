// SPDX-License-Identifier: MIT
// The cycles that `check` expects against those that the machine takes.
#include <gtest/gtest.h>

#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "hw/cost/cycles.h"
#include "tests/backend/bond_cases.h"
#include "tests/backend/rule_cases.h"
#include "tests/support/block.h"

namespace cuboct::test {
namespace {

// Expects the estimate of a step within `tolerance` of what the machine takes, which never does better
// than its lanes and pipes at full use. Returns how many times their cycles it takes.
double machine_over_ideal(const Setup& setup, uint32_t steps, double tolerance = 0.12) {
  const ExpectedCycles expected = expected_cycles(setup.plan, setup.initial);
  emu::RunOptions options;
  options.steps = steps;
  const Trace trace =
      run_loop_bench(setup.plan, setup.initial, options, emu::native_nodes(setup.plan), "plain").trace;
  uint64_t last = 0;
  for (const PhaseSpan& span : trace.cycles) last = std::max(last, span.end);
  const double actual = static_cast<double>(last + 1) / steps;
  EXPECT_NEAR(static_cast<double>(expected.step) / actual, 1, tolerance) << actual;
  EXPECT_LE(static_cast<double>(expected.ideal), actual);
  return actual / static_cast<double>(expected.ideal);
}

Setup moving_block(bool rich, const Arch& arch) {
  return block(
      {.size = {4, 4, 4}, .jitter = 0.01, .speed = 0.001, .damping = rich ? 0.1 : 0, .force_held = rich},
      arch);
}

// Neighbours begin each phase together in the estimate; the machine's nodes drift apart by what they save by
// not waiting, up to a tenth of a step.
TEST(ExpectedCycles, AreWithinTwelvePerCentOfTheMachine) {
  Arch slow, narrow;
  slow.overlap = false;
  slow.filter_lanes = 4;
  narrow.link_bits = 24;
  for (const Arch& arch : {Arch{}, slow, narrow})
    for (const bool rich : {false, true}) {
      const double over = machine_over_ideal(moving_block(rich, arch), 20);
      if (arch.link_bits != narrow.link_bits) {  // those that wait for no links
        EXPECT_LE(over, 1.5);
      }
    }
}

// Nodes that use halos on arrival, with one streamer and with two. How many records the box of the own
// particles lets pass is guessed from the pairs that they make, which adds to the error.
TEST(ExpectedCycles, OnArrivalAreWithinFifteenPerCentOfTheMachine) {
  for (const int streamers : {1, 2})
    for (const bool rich : {false, true}) {
      Arch arch;
      arch.halos = Halos::arrival;
      arch.streamers = streamers;
      arch.force_pipes = 2;
      machine_over_ideal(moving_block(rich, arch), 20, 0.15);
    }
}

// The same of nodes that serve bricks, up to one node that has it all.
TEST(ExpectedCycles, OfBricksAreWithinTwelvePerCentOfTheMachine) {
  for (const Cell& brick : {Cell{2, 2, 2}, Cell{1, 3, 2}, Cell{5, 5, 5}, Cell{6, 6, 6}})
    for (const bool overlap : {true, false}) {
      Arch arch;
      arch.brick = brick;
      arch.overlap = overlap;
      arch.filter_lanes = overlap ? 8 : 3;
      EXPECT_LE(machine_over_ideal(block({.size = {5, 5, 5}, .jitter = 0.01, .speed = 0.001}, arch), 8), 1.5);
    }
}

// Rounds after one another: neighbours begin a round when they have ended the one before. One step, as the
// hot packing crowds some cells soon.
TEST(ExpectedCycles, OfRulesOfTextAreWithinTwelvePerCentOfTheMachine) {
  for (const bool overlap : {true, false}) {
    Arch arch;
    arch.overlap = overlap;
    arch.filter_lanes = overlap ? 8 : 3;
    for (const std::string& rule : {kOneRound, kTwoRounds, kFourRounds})
      machine_over_ideal(case_of("rounds", hot(rule), arch, 1).setup, 1);
    machine_over_ideal(BondedCase(kSprings, {}, arch).c.setup, 8);
  }
}

}  // namespace
}  // namespace cuboct::test
