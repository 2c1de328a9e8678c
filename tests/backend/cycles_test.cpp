// SPDX-License-Identifier: MIT
// The cycles that `check` expects against those that the machine takes.
#include <gtest/gtest.h>

#include "emu/systemc/node.h"
#include "emu/systemc/plain.h"
#include "hw/cycles.h"
#include "tests/support/block.h"

namespace cuboct::test {
namespace {

// The estimate lets neighbours begin each phase together; the machine's nodes drift apart by what they save
// by not waiting, up to a tenth of a step. It never does better than its lanes and pipes.
TEST(ExpectedCycles, AreWithinTwelvePerCentOfTheMachine) {
  Arch slow, narrow;
  slow.overlap = false;
  slow.filter_lanes = 4;
  narrow.link_bits = 24;
  int compared = 0;
  for (const Arch& arch : {Arch{}, slow, narrow})
    for (const bool rich : {false, true}) {
      const auto setup = block(
          {.size = {4, 4, 4}, .jitter = 0.01, .speed = 0.001, .damping = rich ? 0.1 : 0, .force_held = rich},
          arch);
      const ExpectedCycles expected = expected_cycles(setup.plan, setup.initial);
      emu::RunOptions options;
      options.steps = 20;
      const Trace trace =
          run_plain(setup.plan, setup.initial, options, emu::native_nodes(setup.plan), "plain").trace;
      uint64_t last = 0;
      for (const PhaseSpan& span : trace.cycles) last = std::max(last, span.end);
      const double actual = static_cast<double>(last + 1) / 20;
      EXPECT_NEAR(static_cast<double>(expected.step) / actual, 1, 0.12) << actual;
      EXPECT_LE(static_cast<double>(expected.ideal), actual);
      if (compared == 0) {
        EXPECT_LE(actual, 2 * static_cast<double>(expected.ideal));  // the default machine's promise
      }
      ++compared;
    }
  EXPECT_EQ(compared, 6);
}

// The same of nodes that serve bricks, up to one node that has it all.
TEST(ExpectedCycles, OfBricksAreWithinTwelvePerCentOfTheMachine) {
  for (const Cell& brick : {Cell{2, 2, 2}, Cell{1, 3, 2}, Cell{5, 5, 5}, Cell{6, 6, 6}})
    for (const bool overlap : {true, false}) {
      Arch arch;
      arch.brick = brick;
      arch.overlap = overlap;
      arch.filter_lanes = overlap ? 8 : 3;
      const auto setup = block({.size = {5, 5, 5}, .jitter = 0.01, .speed = 0.001}, arch);
      const ExpectedCycles expected = expected_cycles(setup.plan, setup.initial);
      emu::RunOptions options;
      options.steps = 8;
      const Trace trace =
          run_plain(setup.plan, setup.initial, options, emu::native_nodes(setup.plan), "plain").trace;
      uint64_t last = 0;
      for (const PhaseSpan& span : trace.cycles) last = std::max(last, span.end);
      const double actual = static_cast<double>(last + 1) / 8;
      EXPECT_NEAR(static_cast<double>(expected.step) / actual, 1, 0.12) << actual;
      EXPECT_LE(static_cast<double>(expected.ideal), actual);
      EXPECT_LE(actual, 1.5 * static_cast<double>(expected.ideal));
    }
}

}  // namespace
}  // namespace cuboct::test
