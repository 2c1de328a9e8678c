// SPDX-License-Identifier: MIT
// Machines on several devices: the timing model against the clocked nodes, whose links between devices have
// latency and take a beat every so many cycles; their bits against golden's.
#include <gtest/gtest.h>

#include "emu/systemc/node.h"
#include "emu/timing/timing.h"
#include "model/base/error.h"
#include "tests/backend/clocked_timing.h"
#include "tests/backend/engines.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

// Random plans, rebuilt as random machines of all kinds, on random boards.
TEST(BoardsTiming, EqualsTheClockedNode) {
  Seen seen;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    ASSERT_EQ(difference(on_boards(random_case(seed), seed), seen), "");
    ASSERT_EQ(difference(on_boards(rebuilt(random_case(seed), seed), seed + 1000), seen), "");
  }
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    ASSERT_EQ(difference(on_boards(rebuilt(random_flat_case(seed), seed), seed), seen), "");
    ASSERT_EQ(difference(on_boards(random_brick_case(seed), seed), seen), "");
    ASSERT_EQ(difference(on_boards(with_halos_on_arrival(random_case(seed)), seed + 10), seen), "");
  }
  // Hot ones, from which particles leave along two axes and several leave one cell.
  for (const char* name : {"hot_gas", "flat_gas"}) {
    Case hot = make_case(name);
    hot.steps = 10;
    for (const Case& c : {hot, with_halos_on_arrival(hot), with_brick(hot, {2, 2, 1})})
      ASSERT_EQ(difference(on_boards(c, 5), seen), "");
  }
  EXPECT_EQ(seen.boards, seen.runs);
  for (const auto& [what, count] : {std::pair{"cut", seen.cut},
                                    {"serial links", seen.serial_links},
                                    {"late links", seen.late_links},
                                    {"several beats", seen.multi_beat},
                                    {"left", seen.leave},
                                    {"left along two axes", seen.leave_twice},
                                    {"several left a cell", seen.crowds},
                                    {"narrow", seen.narrow},
                                    {"bricks", seen.bricks},
                                    {"arrival", seen.arrival},
                                    {"two streamers", seen.streamers},
                                    {"flat", seen.flat},
                                    {"no overlap", seen.no_overlap},
                                    {"rings of 3", seen.rings_of_3}}) {
    RecordProperty(what, static_cast<int>(count));
    EXPECT_GT(count, 0u) << what;
  }
}

TEST(DeviceCut, CutLinksLeadToOtherDevices) {
  const Case c = with_boards(make_case("periodic_27"), {{2, 3, 1}, 1, 1});
  const Plan& plan = c.setup.plan;
  const DeviceMap map(plan.lattice, plan.bricks, plan.arch.boards);
  EXPECT_EQ(map.devices, 6u);
  for (uint32_t n = 0; n < plan.nodes(); ++n)
    for (int f = 0; f < kFaces; ++f)
      EXPECT_EQ(plan.crosses(n, f), map.device[n] != map.device[plan.neighbour(n, f)]) << n << " " << f;
  // Along y a ring of 3 stands on one device; along x the third node has a device of its own.
  EXPECT_FALSE(plan.crosses(0, 2));
  EXPECT_TRUE(plan.crosses(0, 0));
  EXPECT_FALSE(plan.crosses(0, 1));
  EXPECT_TRUE(plan.crosses(0, 4));
  const Plan whole = with_boards(c, {}).setup.plan;
  EXPECT_TRUE(whole.cut.empty());
  EXPECT_NE(whole.hash, plan.hash);
  EXPECT_EQ(whole.hash, make_case("periodic_27").setup.plan.hash);
}

TEST(DeviceCut, AreRefusedWithChecks) {
  const Plan plan = with_boards(make_case("undamped_2x2x2"), {{1, 1, 1}, 3, 2}).setup.plan;
  Arch arch = plan.arch;
  arch.link_check = LinkCheck::retry;
  EXPECT_EQ(refused_with([&] { make_plan(plan.rule, arch, plan.lattice, plan.origin, plan.particles); }),
            "check = \"retry\" with [boards]: the window of 8 beats and the patience of 15 cycles are "
            "those of a wire\n  hint: leave the check of links between devices to their line code: set "
            "check = \"none\"");
}

// No bit depends on links, without stalls and with them.
TEST(BoardsTiming, LeavesGoldensBits) {
  uint64_t slots = 0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Case c = on_boards(rebuilt(random_case(seed), seed), seed);
    const GoldenRun golden = run_golden(c.setup, c.steps);
    for (const double stalls : {0.0, 0.2}) {
      const Compared compared =
          compare(c.setup.plan, golden,
                  run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps, stalls, seed),
                                 emu::native_nodes(c.setup.plan), "plain"));
      ASSERT_EQ(compared.difference, "") << c.name;
      slots += compared.slots;
    }
  }
  EXPECT_GT(slots, 1000u);
}

// Hand-made: in a lattice of 3 x 2 x 1 nodes each link along x leads to another device. A node of n particles
// loads n beats from cycle 0 on and then the end beat. What is loaded in t is taken in t + 1, or `interval`
// after the one before; then the next is loaded. What is taken is shown `latency` later and seen a cycle
// after that. So the end beat of n > 0 is taken in 1 + n interval. An empty segment takes a cycle.
TEST(BoardsTiming, ExchangeByHand) {
  const Case whole = make_case("lattice_3x2x1");
  const Plan& plan = whole.setup.plan;
  ASSERT_EQ(plan.nodes(), 6u);
  ASSERT_EQ(plan.words.halo_beats, 1);
  const Golden golden(plan.rule, plan.lattice, plan.arch.capacity, whole.setup.initial);
  const emu::CellSlots slots = slots_of(plan.rule, golden);
  for (const int latency : {1, 7, 100})
    for (const int interval : {1, 2, 13}) {
      const Case c = with_boards(whole, {{1, 2, 1}, latency, interval});
      ASSERT_EQ(c.setup.plan.cut, (std::vector<uint8_t>{2, 3, 1, 2, 3, 1}));
      std::vector<PhaseSpan> spans(6 * kPhases);
      emu::TimingModel(c.setup.plan, 1).step(slots, {}, spans);
      const auto count = [&](uint32_t node) { return int64_t{slots.first[node + 1] - slots.first[node]}; };
      const auto seen = [&](uint32_t node) {
        const int64_t n = count(node), taken = n == 0 ? 2 : 1 + n * interval;
        return taken + latency + 1;
      };
      const auto sent = [&](uint32_t node) {
        const int64_t n = count(node), loaded = n == 0 ? 1 : 1 + (n - 1) * interval;
        return loaded + 1;
      };
      for (uint32_t node = 0; node < 6; ++node) {
        int64_t end = sent(node);
        if (node % 3 > 0) end = std::max(end, seen(node - 1));
        if (node % 3 < 2) end = std::max(end, seen(node + 1));
        EXPECT_EQ(spans[node * kPhases].end, static_cast<uint64_t>(end)) << node;
      }
    }
}

}  // namespace
}  // namespace cuboct::test
