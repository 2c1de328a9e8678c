// SPDX-License-Identifier: MIT
// The native node against golden, without the SystemC kernel: every feature, random plans, random stalls,
// faults.
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "emu/systemc/node.h"
#include "emu/systemc/planar.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

emu::RunResult run_native(const Case& c, double stall_rate = 0, uint64_t stall_seed = 1) {
  return run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps, stall_rate, stall_seed),
                        emu::native_nodes(c.setup.plan), "plain");
}

int moves(const GoldenRun& golden) {
  int count = 0;
  for (size_t s = 1; s < golden.states.size(); ++s)
    for (size_t k = 0; k < golden.states[s].particles.size(); ++k)
      count += golden.states[s].particles[k].cell != golden.states[s - 1].particles[k].cell;
  return count;
}

class Native : public testing::TestWithParam<std::string> {};

TEST_P(Native, EqualsGoldenAtEachStep) {
  const Case c = make_case(GetParam());
  const GoldenRun golden = run_golden(c.setup, c.steps);
  ASSERT_FALSE(golden.fault) << golden.fault->what();
  const Compared compared = compare(c.setup.plan, golden, run_native(c));
  EXPECT_EQ(compared.difference, "");
  EXPECT_EQ(compared.steps, c.steps + 1);
  EXPECT_EQ(compared.particles, (c.steps + 1) * c.setup.initial.particles.size());
  EXPECT_EQ(compared.slots, compared.particles);
  EXPECT_TRUE(c.name == "single_node" || moves(golden) > 0);
}

TEST_P(Native, StallsChangeCyclesAndNoBits) {
  const Case c = make_case(GetParam());
  const emu::RunResult free = run_native(c);
  for (const double rate : {0.1, 0.6}) {
    const emu::RunResult stalled = run_native(c, rate, 42);
    EXPECT_EQ(free.trace.state_hash, stalled.trace.state_hash);
    EXPECT_TRUE(free.order == stalled.order);
    EXPECT_EQ(free.trace.cycles == stalled.trace.cycles, c.setup.plan.lattice.size() == 1);
    EXPECT_TRUE(run_native(c, rate, 42).trace.cycles == stalled.trace.cycles);
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Native, testing::ValuesIn(case_names()),
                         [](const auto& p) { return p.param; });

TEST(NativeRandom, EqualsGolden) {
  uint64_t particles = 0, faults = 0, moved = 0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const Case c = random_case(seed);
    const GoldenRun golden = run_golden(c.setup, c.steps);
    for (const double rate : {0.0, 0.3}) {
      const Compared compared = compare(c.setup.plan, golden, run_native(c, rate, seed));
      ASSERT_EQ(compared.difference, "") << c.name << " at stall rate " << rate;
      ASSERT_EQ(compared.steps, golden.states.size());
      particles += compared.particles;
    }
    faults += golden.fault.has_value();
    moved += static_cast<uint64_t>(moves(golden));
  }
  EXPECT_GT(particles, 20000u);
  EXPECT_GT(moved, 200u);
  EXPECT_GT(faults, 0u);
  EXPECT_LT(faults, 40u);
  RecordProperty("particle_steps", static_cast<int>(particles));
}

void expect_faults_of_golden(const std::function<Case(Fault)>& case_of) {
  int seen = 0;
  for (const Fault fault : all_faults()) {
    const Case c = case_of(fault);
    const GoldenRun golden = run_golden(c.setup, c.steps);
    ASSERT_TRUE(golden.fault) << c.name;
    EXPECT_EQ(golden.fault->fault, fault) << golden.fault->what();
    for (const double rate : {0.0, 0.4}) {
      const emu::RunResult result = run_native(c, rate);
      EXPECT_EQ(compare(c.setup.plan, golden, result).difference, "") << c.name;
      ASSERT_TRUE(result.trace.stop) << c.name;
      EXPECT_EQ(result.trace.stop->fault, fault);
      EXPECT_EQ(result.trace.stop->number, golden.fault->number);
      EXPECT_EQ(result.trace.steps(), golden.fault->step);
      EXPECT_EQ(result.trace.cycles.size(), golden.fault->step * c.setup.plan.lattice.size() * kPhases);
    }
    ++seen;
  }
  EXPECT_EQ(seen, 11);
}

TEST(NativeFaults, EachArisesAsInGolden) { expect_faults_of_golden(fault_case); }

TEST(NativeFaults, EachArisesOnArrivalToo) {
  expect_faults_of_golden([](Fault fault) { return with_halos_on_arrival(fault_case(fault)); });
}

TEST(NativeFaults, CapacityHoldsAtTheLimit) {
  for (const Fault fault : {Fault::full_x, Fault::full_y, Fault::full_z}) {
    Case c = fault_case(fault);
    c.setup.plan.arch.capacity = 5;
    c.setup.plan =
        make_plan(c.setup.plan.rule, c.setup.plan.arch, c.setup.plan.lattice, c.setup.plan.origin, 5);
    const GoldenRun golden = run_golden(c.setup, 12);
    ASSERT_FALSE(golden.fault);
    size_t fullest = 0;
    for (const auto& step : golden.order)
      for (const auto& cell : step) fullest = std::max(fullest, cell.size());
    EXPECT_EQ(fullest, 5u);
    c.steps = 12;
    EXPECT_EQ(compare(c.setup.plan, golden, run_native(c)).difference, "");
  }
}

TEST(NativeFaults, AFullCellAtTheStartIsRefusedAsByGolden) {
  Case c = make_case("undamped_2x2x2");
  c.setup.plan.arch.capacity = 3;
  const GoldenRun golden = run_golden(c.setup, 1);
  ASSERT_TRUE(golden.fault);
  EXPECT_EQ(refused_with<RunError>([&] { run_native(c); }), golden.fault->what());
}

// Four slots at a time, at the limits of the formats and on both sides of each plane.
TEST(NativePlanar, EqualsMayInteract) {
  std::mt19937_64 random(3);
  const auto draw = [&](int64_t low, int64_t high) {
    return std::uniform_int_distribution<int64_t>(low, high)(random);
  };
  static emu::PlanarSlots slots;
  uint64_t met = 0, passed = 0, edges = 0;
  for (const auto& [p, b] : {std::pair{20, 8}, {30, 16}, {30, 6}, {8, 8}, {12, 2}})
    for (int run = 0; run < 200; ++run) {
      FixedRule rule;
      rule.widths.position_frac = p;
      rule.widths.filter_frac = b;
      const int64_t cell = int64_t{1} << p, cutoff = draw(1, int64_t{1} << b);
      rule.planar = {cutoff, cutoff * 1414214 / 1000000 + 1, cutoff * 1732051 / 1000000 + 1};
      const emu::PlanarTest test(rule);
      std::array<int32_t, 3> candidate{};
      for (int32_t& x : candidate)
        x = static_cast<int32_t>(run % 10 == 0 ? (run % 20 == 0 ? -cell : 2 * cell - 1)
                                               : draw(-cell, 2 * cell - 1));
      const int count = run % 7 == 0 ? emu::kPlanarSlots : static_cast<int>(draw(0, 70));
      std::vector<Int3> own;
      slots.clear();
      for (int k = 0; k < count; ++k) {
        std::array<int32_t, 3> x{};
        for (size_t a = 0; a < 3; ++a) {
          // Half of them a plane's distance away, or one unit more.
          const int64_t near = candidate[a] + (draw(0, 1) ? 1 : -1) * (rule.planar[0] << (p - b)) +
                               draw(-1, 1) * (int64_t{1} << (p - b));
          const bool on_plane = draw(0, 1) && near >= 0 && near < cell;
          edges += on_plane;
          x[a] = static_cast<int32_t>(on_plane ? near : draw(0, 3) == 0 ? cell - 1 : draw(0, cell - 1));
        }
        slots.add(x, test.shift());
        own.push_back({x[0], x[1], x[2]});
      }
      const emu::PlanarMask mask = test(slots, candidate);
      for (int k = 0; k < emu::kPlanarSlots; ++k) {
        const bool got = mask.from(static_cast<uint32_t>(k)) & 1;
        const bool expected = k < count && may_interact(rule, own[static_cast<size_t>(k)],
                                                        {candidate[0], candidate[1], candidate[2]});
        ASSERT_EQ(got, expected) << "P " << p << " B " << b << " run " << run << " slot " << k;
        met += k < count;
        passed += expected;
      }
    }
  EXPECT_GT(met, 50000u);
  EXPECT_GT(passed, 2000u);
  EXPECT_GT(edges, 5000u);
}

TEST(Native, NoStepsShowsTheInitialState) {
  Case c = make_case("undamped_2x2x2");
  c.steps = 0;
  const Compared compared = compare(c.setup.plan, run_golden(c.setup, 0), run_native(c));
  EXPECT_EQ(compared.difference, "");
  EXPECT_EQ(compared.steps, 1u);
}

}  // namespace
}  // namespace cuboct::test
