// SPDX-License-Identifier: MIT
// Faults on the wires of native nodes: each kind on each beat, found and named, or healed.
#include <gtest/gtest.h>

#include "emu/systemc/node.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

using emu::FaultKind;

emu::RunResult run(const Case& c, const emu::RunOptions& options) {
  return run_loop_bench(c.setup.plan, c.setup.initial, options, emu::native_nodes(c.setup.plan), "plain");
}

// The states that a run that stopped on a link did reach are golden's.
std::string before_stop(const Plan& plan, const GoldenRun& golden, const emu::RunResult& run) {
  for (size_t s = 0; s < run.trace.state_hash.size(); ++s)
    if (run.trace.state_hash[s] != hash_of(plan.lattice, golden.states.at(s)))
      return "step " + std::to_string(s) + ": hash differs";
  return {};
}

// A beat with checks takes two cycles more; which check makes no difference, and nothing else changes.
TEST(CheckedLinks, CostTwoCyclesPerBeatAndNoBits) {
  for (const std::string name : {"undamped_2x2x2", "flat_ring", "rich_ring", "lattice_3x2x1"}) {
    const Case none = make_case(name), detect = make_case(name + ".detect"),
               retry = make_case(name + ".retry");
    const GoldenRun golden = run_golden(none.setup, none.steps);
    const auto options = keep_all(none.steps), stalled = keep_all(none.steps, 0.4, 5);
    const emu::RunResult n = run(none, options), d = run(detect, options), r = run(retry, options);
    for (const emu::RunResult& got : {n, d, r, run(detect, stalled), run(retry, stalled)})
      EXPECT_EQ(compare(none.setup.plan, golden, got).difference, "") << name;
    EXPECT_EQ(compare_cycles(d, r).difference, "") << name;
    // The first exchange: an end beat is seen four cycles after it is loaded, in place of two.
    const auto length = [](const emu::RunResult& run) { return run.trace.cycles[0].end; };
    EXPECT_GE(length(d), length(n)) << name;
    EXPECT_LE(length(d), length(n) + 2) << name;
    EXPECT_LT(n.trace.counters[0].second, d.trace.counters[0].second) << name;
  }
}

// Every beat of every wire of a small lattice, in each way.
class EachBeat : public testing::TestWithParam<FaultKind> {
 protected:
  void is_found_and_named(const Case& c);
  void is_healed(const Case& c);
  // Calls see(target, result) for each beat of the run; how many there were.
  template <typename See>
  uint64_t for_each_beat(const Case& c, See see) {
    const Plan& plan = c.setup.plan;
    uint64_t beats = 0;
    for (uint32_t n = 0; n < plan.nodes(); ++n)
      for (int f = 0; f < kFaces; ++f) {
        if (plan.neighbour(n, f) == kNoNode) continue;
        for (uint64_t beat = 0;; ++beat, ++beats) {
          emu::RunOptions options = keep_all(2);
          options.faults.target = {n, f, beat, GetParam()};
          options.faults.seed = beats;
          const emu::RunResult result = run(c, options);
          if (result.faults.injected() == 0) break;
          see(options.faults.target, result);
          if (testing::Test::HasFailure()) {
            ADD_FAILURE() << "node " << n << ", face " << f << ", beat " << beat;
            return beats;
          }
        }
      }
    return beats;
  }
};

// A link that fails stops the run at a node; a brick is told by its first cell.
void EachBeat::is_found_and_named(const Case& c) {
  const Plan& plan = c.setup.plan;
  const GoldenRun golden = run_golden(c.setup, 2);
  uint64_t silent = 0, stopped = 0;
  const uint64_t beats = for_each_beat(c, [&](const emu::FaultTarget& t, const emu::RunResult& got) {
    EXPECT_EQ(got.faults.detected, 1u);
    EXPECT_EQ(got.faults.healed, 0u);
    // An acknowledgement of the last beats may be wrong after the last step; all has come then.
    if (!got.trace.stop) {
      EXPECT_TRUE(t.kind == FaultKind::ack || t.kind == FaultKind::repeat);
      EXPECT_EQ(compare(plan, golden, got).difference, "");
      return;
    }
    ++stopped;
    const StopReason& stop = *got.trace.stop;
    EXPECT_EQ(before_stop(plan, golden, got), "");
    const uint32_t receiver = plan.neighbour(t.node, t.face);
    const bool by_sender = t.kind == FaultKind::ack || stop.fault == Fault::link_silent;
    EXPECT_EQ(stop.cell, plan.cell_of(by_sender ? t.node : receiver, 0));
    EXPECT_EQ(stop.number, by_sender ? t.face : t.face ^ 1);
    EXPECT_LE(stop.step, 2u);
    const Fault expected = t.kind == FaultKind::flip || t.kind == FaultKind::ack ? Fault::link_check
                           : by_sender                                           ? Fault::link_silent
                                                                                 : Fault::link_order;
    EXPECT_EQ(stop.fault, expected);
    silent += stop.fault == Fault::link_silent;
  });
  EXPECT_GT(beats, 100u);
  EXPECT_GT(stopped, beats * 9 / 10);
  // Among the lost ones are the last beats of streams, which no other beat follows.
  EXPECT_EQ(silent > 0, GetParam() == FaultKind::drop);
}

TEST_P(EachBeat, IsFoundAndNamed) { is_found_and_named(make_case("lattice_3x2x1.detect")); }

TEST_P(EachBeat, IsFoundAndNamedBetweenBricks) {
  is_found_and_named(with_brick(make_case("lattice_3x2x1.detect"), {2, 1, 1}));
}

void EachBeat::is_healed(const Case& c) {
  const GoldenRun golden = run_golden(c.setup, 2);
  const uint64_t beats = for_each_beat(c, [&](const emu::FaultTarget&, const emu::RunResult& got) {
    EXPECT_EQ(got.faults.detected, 1u);
    EXPECT_EQ(got.faults.healed, 1u);
    EXPECT_EQ(compare(c.setup.plan, golden, got).difference, "");
  });
  EXPECT_GT(beats, 100u);
}

TEST_P(EachBeat, IsHealed) { is_healed(make_case("lattice_3x2x1.retry")); }

TEST_P(EachBeat, IsHealedBetweenBricks) {
  is_healed(with_brick(make_case("lattice_3x2x1.retry"), {2, 1, 1}));
}

constexpr const char* kKind[] = {"none", "flip", "drop", "repeat", "ack"};
INSTANTIATE_TEST_SUITE_P(Kinds, EachBeat,
                         testing::Values(FaultKind::flip, FaultKind::drop, FaultKind::repeat, FaultKind::ack),
                         [](const auto& p) { return kKind[static_cast<size_t>(p.param)]; });

// Many faults in one run, with and without stalls, where particles move: all bits are golden's.
TEST(Retry, HealsHundredsOfFaults) {
  emu::FaultCounts all;
  for (const std::string name : {"flat_ring", "rich_ring", "undamped_2x2x2", "rich_damped"})
    for (const double stalls : {0.0, 0.3}) {
      const Case c = make_case(name + ".retry");
      emu::RunOptions options = keep_all(c.steps, stalls, 3);
      options.faults.rate = 0.03;
      const emu::RunResult got = run(c, options);
      EXPECT_EQ(compare(c.setup.plan, run_golden(c.setup, c.steps), got).difference, "") << name;
      EXPECT_EQ(got.faults.detected, got.faults.injected()) << name;
      EXPECT_EQ(got.faults.healed, got.faults.injected()) << name;
      EXPECT_GT(got.faults.injected(), 100u) << name;
      all.flips += got.faults.flips;
      all.drops += got.faults.drops;
      all.repeats += got.faults.repeats;
      all.acks += got.faults.acks;
    }
  EXPECT_GT(all.flips, 200u);
  EXPECT_GT(all.drops, 200u);
  EXPECT_GT(all.repeats, 200u);
  EXPECT_GT(all.acks, 200u);
}

// One fault in ten beats: faults meet beats that are sent again.
TEST(Retry, HealsWhereFaultsFollowEachOther) {
  const Case c = make_case("undamped_2x2x2.retry");
  emu::RunOptions options = keep_all(c.steps);
  options.faults.rate = 0.1;
  const emu::RunResult got = run(c, options);
  EXPECT_EQ(compare(c.setup.plan, run_golden(c.setup, c.steps), got).difference, "");
  EXPECT_GT(got.faults.injected(), 500u);
  EXPECT_EQ(got.faults.detected, got.faults.injected());
}

// A count is met, spread over the run; the same seed gives the same faults.
TEST(Faults, ComeInTheNumberAskedForAndAgain) {
  const Case c = make_case("rich_ring.retry");
  emu::RunOptions options = keep_all(c.steps);
  options.faults.count = 200;
  const emu::RunResult a = run(c, options), b = run(c, options);
  EXPECT_EQ(a.faults.injected(), 200u);
  EXPECT_EQ(compare_cycles(a, b).difference, "");
  EXPECT_EQ(a.first_fault.cycle, b.first_fault.cycle);
  options.faults.seed = 2;
  const emu::RunResult other = run(c, options);
  EXPECT_NE(compare_cycles(a, other).difference, "");
  const auto counter = [&](const std::string& name) {
    for (const auto& [key, value] : a.trace.counters)
      if (key == name) return value;
    return -1.0;
  };
  EXPECT_EQ(counter("faults_injected"), 200);
  EXPECT_EQ(counter("faults_detected"), 200);
  EXPECT_EQ(counter("faults_healed"), 200);
  EXPECT_GT(counter("link_resends"), 50);
}

TEST(Detect, SaysWhereInWords) {
  const Case c = make_case("lattice_3x2x1.detect");
  const auto text = [&](FaultKind kind, uint64_t beat) {
    emu::RunOptions options = keep_all(2);
    options.faults.target = {0, 1, beat, kind};
    return run(c, options).trace.stop->text;
  };
  EXPECT_EQ(text(FaultKind::flip, 0), "step 0, node of cell 1 at (1, 0, 0), link -x: wrong check of a beat");
  EXPECT_EQ(text(FaultKind::repeat, 0),
            "step 0, node of cell 1 at (1, 0, 0), link -x: beat lost or repeated");
  EXPECT_EQ(text(FaultKind::drop, 0), "step 0, node of cell 1 at (1, 0, 0), link -x: beat lost or repeated");
  EXPECT_EQ(text(FaultKind::ack, 0), "step 0, node of cell 0 at (0, 0, 0), link +x: wrong check of a beat");
}

// Without a check the same faults make wrong bits, or a machine that waits for ever, and no one says where.
TEST(Unchecked, LinksLetFaultsThrough) {
  const Case c = make_case("undamped_2x2x2");
  const GoldenRun golden = run_golden(c.setup, c.steps);
  uint64_t wrong = 0, stuck = 0, harmless = 0;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    emu::RunOptions options = keep_all(c.steps);
    options.faults.count = 1;
    options.faults.seed = seed;
    options.patience = 2000;
    try {
      const emu::RunResult got = run(c, options);
      EXPECT_EQ(got.faults.detected, 0u);
      ++(compare(c.setup.plan, golden, got).difference.empty() ? harmless : wrong);
    } catch (const std::runtime_error&) {
      ++stuck;
    }
  }
  // A record that no one is near, or that is there twice, changes nothing.
  EXPECT_GT(wrong + stuck, 30u);
  EXPECT_EQ(wrong + stuck + harmless, 60u);
  // Of the beats of one wire, the lost ends of streams stop the machine.
  stuck = 0;
  for (uint64_t beat = 0; beat < 12; ++beat) {
    emu::RunOptions options = keep_all(1);
    options.faults.target = {0, 1, beat, FaultKind::drop};
    options.patience = 2000;
    try {
      run(c, options);
    } catch (const std::runtime_error& e) {
      EXPECT_EQ(std::string(e.what()).substr(0, 6), "stuck:");
      ++stuck;
    }
  }
  EXPECT_GT(stuck, 0u);
}

}  // namespace
}  // namespace cuboct::test
