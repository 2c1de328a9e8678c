// SPDX-License-Identifier: MIT
#include "study/sweep/cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hw/cost/node_area.h"
#include "hw/plan/setup.h"

namespace cuboct::study {
namespace {

// Four cells a side, no damping.
const Base& block() {
  static const Base base = read_base(CUBOCT_SOURCE_DIR "/scenes/undamped_block.toml",
                                     CUBOCT_SOURCE_DIR "/tests/study/formats.toml");
  return base;
}

double cost(std::vector<Change> scene, std::vector<Change> arch = {}, Arithmetic a = Arithmetic::fixed) {
  Settings settings;
  settings.arithmetic = a;
  settings.engine = a == Arithmetic::fixed ? "lattice" : "reference";
  settings.scene = std::move(scene);
  settings.arch = std::move(arch);
  return cost_of(resolve(block(), settings));
}

TEST(Cost, GoesWithTheStepsPerSecond) {
  const double base = cost({{"run.dt_safety", "0.2"}});
  // The force table holds f dt^2, so that the width of its values may change by a bit, of some 100 in all.
  EXPECT_NEAR(cost({{"run.dt_safety", "0.1"}}) / base, 2, 0.02);
  EXPECT_NEAR(cost({{"run.dt_safety", "0.4"}}) / base, 0.5, 0.005);
  const double real = cost({{"run.dt_safety", "0.2"}}, {}, Arithmetic::float64);
  EXPECT_DOUBLE_EQ(cost({{"run.dt_safety", "0.1"}}, {}, Arithmetic::float64) / real, 2);
}

TEST(Cost, ACoarserPackingIsCheaper) {
  // The same block of 2.8 mm: particles go with pitch^-3, steps with 1/pitch; twice the pitch leaves a
  // sixteenth, or less, as more of the particles are at the surface and miss partners.
  const auto packed = [](const char* pitch) {
    return cost(
        {{"packing.pitch", pitch}, {"box.cells", ""}, {"box.size", "\"[2.8284, 2.8284, 2.8284] mm\""}});
  };
  const double fine = packed("\"0.25 mm\""), middle = packed("\"0.35 mm\""), coarse = packed("\"0.5 mm\"");
  EXPECT_LT(coarse, middle);
  EXPECT_LT(middle, fine);
  EXPECT_GT(fine / coarse, 16);
  EXPECT_LT(fine / coarse, 24);
}

TEST(Cost, FewerBitsAreCheaper) {
  const std::vector<Change> damped{{"damping.ratio", "0.1"}};
  struct Key {
    const char* name;
    std::vector<int> values;  // from cheap to dear
  };
  const Key keys[] = {{"widths.difference_frac", {10, 12, 14, 16}},
                      {"widths.strength_bits", {14, 16, 18, 20}},
                      {"widths.velocity_bits", {25, 26, 27, 29}},
                      {"widths.relative_velocity_bits", {14, 16, 18}},
                      {"widths.guard", {8, 9, 10}},
                      {"table.index_bits", {6, 8, 9, 11}},
                      {"table.fraction_bits", {8, 12, 16}},
                      {"table.degree", {1, 2}}};
  for (const Key& key : keys)
    for (size_t i = 1; i < key.values.size(); ++i)
      EXPECT_LT(cost(damped, {{key.name, std::to_string(key.values[i - 1])}}),
                cost(damped, {{key.name, std::to_string(key.values[i])}}))
          << key.name << " = " << key.values[i - 1];
  // Positions with their difference's and velocity's widths as they are.
  EXPECT_LT(cost({}, {{"widths.position_frac", "18"}, {"widths.guard", "10"}}), cost({}));
}

TEST(Cost, WhatASceneUsesIsPaid) {
  const double plain = cost({});
  const double damped = cost({{"damping.ratio", "0.1"}});
  // Twice the tables and the products w.d, and velocities in every record.
  EXPECT_GT(damped / plain, 1.5);
  EXPECT_LT(damped / plain, 3);
  Base base = block();
  base.scene_text +=
      "\n[[constraint]]\nname = \"h\"\nkind = \"held_by_force\"\n"
      "region = { shape = \"sphere\", radius = \"1 mm\" }\n";
  const Case held = resolve(base, {});
  // kp u and kd (v - V), 18 bits by 29 and 30, per axis.
  const double products = area_of(plan_of(held.scene, held.arch)).multipliers;
  const Case free = resolve(block(), {});
  EXPECT_DOUBLE_EQ(products - area_of(plan_of(free.scene, free.arch)).multipliers, 34.0 * 3 * 18 * (29 + 30));
}

TEST(Cost, PrecisionsInTheirOrder) {
  const double fixed = cost({}), f32 = cost({}, {}, Arithmetic::float32),
               f64 = cost({}, {}, Arithmetic::float64);
  EXPECT_LT(fixed, f32);
  EXPECT_LT(f32, f64);
}

// By hand, against rtl/lib: P 20, G 8, D 16, 18-bit entries, T 17, 512 entries, no damping.
TEST(Cost, TheDefaultPipeByHand) {
  const Case c = resolve(block(), {});
  const Plan plan = plan_of(c.scene, c.arch);
  ASSERT_EQ(plan.rule.widths.strength_bits, 18);
  ASSERT_FALSE(plan.rule.damped);
  const NodeArea area = area_of(plan);
  // Squares of 17 bits, slope times t, strength (as wide as its values, at most 18 here) times d.
  EXPECT_DOUBLE_EQ(area.multipliers, 34.0 * (3 * 17 * 17 + 18 * 18 + 3 * 18 * 17));
  EXPECT_DOUBLE_EQ(area.tables, 6.0 * 512 * 2 * 18);
  // Pipe: differences of 23 bits and their rounding to 17, two sums of r2, the table's, kicks, sums. A lane:
  // differences, then 17 adders and comparisons of 21 bits. Update, per axis: two of v, one of x
  // with its residue, 20 + 8 bits and 2 of the cell.
  const double kick = 18 + 17 - plan.rule.kick_shift;
  const double pipe = 3 * 23 + 3 * 17 + 2 * 34 + 18 + 3 * kick + 3 * (kick + 9), lane = 3 * 23 + 17 * 21;
  EXPECT_DOUBLE_EQ(area.adders, 28.0 * (pipe + 8 * lane + 3 * (2 * 29 + 30)));
  // 16 slots and 6 x 16 arrivals of a particle, 26 x 16 halos of 64 bits, 16 queued with 8 mask bits.
  EXPECT_EQ(plan.words.halo_bits, 64);
  const double sum = kick + 9;  // 27 * 16 kicks
  EXPECT_DOUBLE_EQ(area.particles,
                   6.0 * (7 * 16 * plan.words.particle_bits + 26 * 16 * 64 + 16 * (64 + 8) + 16 * 3 * sum));
  // Every second one of 8 x 8 x 8 places in half cells is a site: along each of the six directions of nearest
  // neighbours 7 x 7 x 8 / 2 pairs. Second neighbours stand at the cutoff and do not count.
  const double pairs = 6 * 7 * 7 * 8 / 2;
  EXPECT_NEAR(cost_of(c), area.transistors() * 2 * pairs / c.scene.rule.dt, 1e-9 * cost_of(c));
}

}  // namespace
}  // namespace cuboct::study
