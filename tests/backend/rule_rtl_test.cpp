// SPDX-License-Identifier: MIT
// Rules of text as emitted hardware, Verilated: golden's bits, order and faults, the native node's cycles.
#include <gtest/gtest.h>

#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "emu/verilated/verilated_node.h"
#include "tests/backend/bond_cases.h"
#include "tests/backend/engines.h"
#include "tests/backend/rule_cases.h"

namespace cuboct::test {
namespace {

struct RuleCase {
  const char* name;
  std::string rule;
  uint64_t steps;
  bool fails;
  int filter_lanes, force_pipes, queue_depth;
  bool overlap;
  int link_bits;
  LinkCheck check = LinkCheck::none;
};

Arch arch_of(const RuleCase& c) {
  Arch arch;
  arch.filter_lanes = c.filter_lanes, arch.force_pipes = c.force_pipes, arch.queue_depth = c.queue_depth;
  arch.overlap = c.overlap, arch.link_bits = c.link_bits, arch.link_check = c.check;
  return arch;
}

class RuleRtl : public testing::TestWithParam<RuleCase> {};

// Free and with links that stall.
void expect_golden(const Case& c, bool fails) {
  const Plan& plan = c.setup.plan;
  const auto rtl_nodes = emu::verilated_nodes(plan, CUBOCT_TEST_CACHE, 7, "-O1");
  const GoldenRun golden = run_golden(c.setup, c.steps);
  EXPECT_EQ(golden.fault.has_value(), fails);
  for (const double rate : {0.0, 0.3}) {
    const auto options = keep_all(c.steps, rate);
    const auto rtl = run_loop_bench(plan, c.setup.initial, options, rtl_nodes, "rtl");
    const auto native = run_loop_bench(plan, c.setup.initial, options, emu::native_nodes(plan), "plain");
    const Compared compared = compare(plan, golden, rtl);
    EXPECT_EQ(compared.difference, "") << rate;
    EXPECT_GT(compared.slots, 100u);
    const Compared cycles = compare_cycles(native, rtl);
    EXPECT_EQ(cycles.difference, "") << rate;
    EXPECT_GT(cycles.spans,
              plan.nodes() * static_cast<uint64_t>(phases_of(static_cast<int>(plan.rounds.size()))));
  }
}

TEST_P(RuleRtl, HoldsGoldensBitsAndTheNativeNodesCycles) {
  const RuleCase& p = GetParam();
  expect_golden(case_of(p.name, hot(p.rule), arch_of(p), p.steps), p.fails);
}

const auto kName = [](const testing::TestParamInfo<RuleCase>& p) { return std::string(p.param.name); };
INSTANTIATE_TEST_SUITE_P(
    Rules, RuleRtl,
    testing::Values(RuleCase{"one_round", kOneRound, 6, false, 8, 1, 16, true, 0},
                    RuleCase{"still", kStill, 6, false, 3, 2, 4, true, 20},
                    RuleCase{"three_rounds", failing(false, false), 2, false, 3, 2, 4, true, 40},
                    RuleCase{"four_rounds", kFourRounds, 6, false, 3, 2, 4, true, 40},
                    RuleCase{"checked", kFourRounds, 4, false, 1, 1, 1, false, 23, LinkCheck::retry},
                    RuleCase{"wide", kFourRounds, 6, false, 16, 4, 8, false, 0},
                    RuleCase{"fails", failing(true, true), 9, true, 4, 2, 8, true, 0},
                    RuleCase{"fails_late", failing(false, true), 9, true, 4, 1, 8, true, 0}),
    kName);

TEST(RuleRtlBonds, OfSpringsThatBreakAreGoldens) {
  Arch arch;
  arch.filter_lanes = 3, arch.force_pipes = 2, arch.queue_depth = 4, arch.link_bits = 60;
  const BondedCase body(kSprings, {Vec3(900, 700, 500), 60, 0}, arch, 5);
  expect_golden(body.c, false);
  Golden golden = golden_of(body.c.setup);
  const State before = golden.state();
  for (uint64_t step = 0; step < body.c.steps; ++step) golden.step();
  const State after = golden.state();
  uint64_t broken = 0, moved = 0;
  for (size_t b = 0; b < before.bonds.size(); ++b) broken += after.bonds[b] != before.bonds[b];
  for (size_t k = 0; k < before.particles.size(); ++k)
    moved += after.particles[k].cell != before.particles[k].cell;
  EXPECT_GT(broken, 10u);
  EXPECT_LT(broken, before.bonds.size());
  EXPECT_GT(moved, 10u);
}

// Constants by type of one and of both; and a layer without a third axis.
TEST(RuleRtlBonds, OfTypesAndOfLayersAreGoldens) {
  const std::string rule = R"toml(reach = "1.3 * pitch"
[rule.particle.T]
unit = "K"
range = "[0, 2000] K"
start = "300 K + 100 K * x.x / pitch"
[[rule.round]]
sum.heat = "mass_j / (mass_i + mass_j) * (T_j - T_i)"
sum.force = "1 kN/m * mass_j / (mass_i + mass_j) * (r - pitch) * d / r"
finish.T = "T + heat / 30"
)toml";
  const std::string materials =
      "[regions]\nright = { shape = \"half_space\", point = \"[2.5, 0, 0] mm\", normal = \"-x\" }\n"
      "[[material]]\nname = \"light\"\n[[material]]\nname = \"heavy\"\ndensity = \"19 g/cm^3\"\nregion = "
      "\"right\"\n";
  const Case two = case_of("types", hot(rule, materials), {}, 4);
  ASSERT_EQ(two.setup.plan.program->program.types, 2);
  expect_golden(two, false);
  const std::string layer =
      replaced(replaced(kSprings, "min = \"[0, 0, 0] mm\"\nmax = \"[3.5, 3, 2] mm\"\n",
                        "min = \"[0, 0, -0.5] mm\"\nmax = \"[5, 4, 0.5] mm\"\n"),
               "pitch = \"1 mm\"\n", "pitch = \"1 mm\"\naxes = [[1, -1, 0], [1, 1, -2]]\n");
  const BondedCase sheet(layer, {Vec3(900, 700, 0), 60, 0, true}, {}, 6);
  ASSERT_EQ(sheet.c.setup.plan.rule.axes, 2);
  expect_golden(sheet.c, false);
}

// Glass that is torn apart, a bond that is lost, and a yielding body that goes through the cells.
TEST(RuleRtlBonds, AreGoldens) {
  Arch pipes;
  pipes.filter_lanes = 3, pipes.force_pipes = 2, pipes.link_bits = 60;
  for (const Arch& arch : {Arch(), pipes}) {
    expect_golden(BondedCase(kGlass, {Vec3::Zero(), 10, 0.02}, arch, 12).c, false);
    expect_golden(BondedCase(kGlass, {Vec3::Zero(), 10, 0.3}, arch, 8).c, true);
    expect_golden(BondedCase(kPlastic, {Vec3(900, 700, 500), 5, 0}, arch, 8).c, false);
  }
}

}  // namespace
}  // namespace cuboct::test
