// SPDX-License-Identifier: MIT
// The fixed gpu engine holds golden's bits, whatever the slabs, blocks and cuts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/gpu/beside_golden.h"
#include "tests/support/block.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

gpu::Options slabs(int count, int block = 128) {
  gpu::Options options;
  options.devices.assign(static_cast<size_t>(count), 0);
  options.block = block;
  return options;
}

constexpr int kBlocks[] = {32, 128, 256};
constexpr Cut kCuts[] = {Cut::whole, Cut::single, Cut::random};

// Every number of slabs that fits, each with another block and cut.
void compare_all(const Case& c, uint64_t seed, Met& met) {
  const GoldenPath golden = golden_path(c);
  const int most = most_slabs(c.setup.plan);
  for (int s = 1; s <= most; ++s) {
    const auto k = static_cast<size_t>(s) + seed;
    compare(c, golden, slabs(s, kBlocks[k % 3]), kCuts[k % 3], seed, met);
    if (s == 1 || seed % 4 == 0) compare(c, golden, slabs(s, kBlocks[(k + 2) % 3]), kCuts[(k + 1) % 3], seed + 1, met);
    if (testing::Test::HasFatalFailure()) return;
  }
}

class FixedCases : public testing::TestWithParam<std::string> {};

TEST_P(FixedCases, HoldGoldensBits) {
  const Case c = make_case(GetParam());
  Met met;
  compare_all(c, 0, met);
  EXPECT_GT(met.updates, 0u);
}

INSTANTIATE_TEST_SUITE_P(Gpu, FixedCases, testing::ValuesIn(case_names()), [](const auto& p) { return p.param; });

struct Named {
  std::string scene;
  uint64_t steps;
  int slabs;  // of the second run
};

class FixedScenes : public testing::TestWithParam<Named> {};

TEST_P(FixedScenes, HoldGoldensBits) {
  const Scene scene = read_scene(std::string(CUBOCT_SOURCE_DIR) + "/scenes/" + GetParam().scene + ".toml");
  const Case c{GetParam().scene, make_setup(scene, {}), GetParam().steps, scene};
  const GoldenPath golden = golden_path(c);
  ASSERT_EQ(golden.hashes.size(), c.steps);
  ASSERT_LE(GetParam().slabs, most_slabs(c.setup.plan));
  Met met;
  compare(c, golden, slabs(1), Cut::whole, 1, met);
  compare(c, golden, slabs(GetParam().slabs), Cut::random, 2, met);
}

INSTANTIATE_TEST_SUITE_P(Gpu, FixedScenes,
                         testing::Values(Named{"coupon", 12, 4}, Named{"hot_cluster", 200, 2},
                                         Named{"lj_block", 30, 1}, Named{"two_types", 30, 2},
                                         Named{"undamped_block", 30, 1}, Named{"sheet", 60, 2}),
                         [](const auto& p) { return p.param.scene; });

TEST(FixedRandom, HoldGoldensBits) {
  Met met;
  for (uint64_t seed = 1; seed <= 120; ++seed) {
    compare_all(seed % 5 == 0 ? random_flat_case(seed) : random_case(seed), seed, met);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(met.runs, 200u);
  EXPECT_GT(met.crossed, 400u);
  EXPECT_GT(met.faults, 5u);
}

TEST(FixedRandom, BarsOfSeveralSlabsHoldGoldensBits) {
  Met met;
  int refused = 0, wide = 0, rings = 0, four = 0, pd = 0;
  for (uint64_t seed = 1; seed <= 220; ++seed) {
    Case c;
    try {
      c = random_bar(seed);
    } catch (const InputError&) {
      ++refused;
      continue;
    }
    const Plan& plan = c.setup.plan;
    wide += plan.rule.widths.velocity_bits > 32;
    for (int a = 0; a < 3; ++a) rings += plan.lattice.period()[a] > 0;
    pd += plan.rule.pd;
    four += most_slabs(plan) == 4;
    compare_all(c, seed, met);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(met.runs, 200u) << refused << " refused";
  EXPECT_GT(wide, 20);
  EXPECT_GT(rings, 20);
  EXPECT_GT(four, 20);
  EXPECT_GT(pd, 10);
  EXPECT_GT(met.crossed, 5000u);
  EXPECT_GT(met.faults, 20u);
  EXPECT_GT(met.halo, 10000u);
}

}  // namespace
}  // namespace cuboct::test
