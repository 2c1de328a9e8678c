// SPDX-License-Identifier: MIT
// Formats and capacity that a scene chooses for itself.
#include "hw/arch/auto_widths.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hw/plan/setup.h"
#include "model/analysis/motion.h"
#include "model/base/error.h"
#include "model/contract/golden.h"

namespace cuboct {
namespace {

// E = 3 GPa, 6 mm long.
const std::string kBar = R"(
density = "1.41 g/cm^3"
[packing]
pitch = "0.5 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[6, 1.5, 1.5] mm"
[law]
kind = "elastic"
youngs_modulus = "3 GPa"
direction = [1, 0, 0]
)";

// Its ends `held` and `moved` along x.
Scene drawn_bar(const std::string& velocity, const std::string& run, const std::string& top = "") {
  return parse_scene(top + kBar + R"([[constraint]]
name = "fixed"
kind = "held"
region = { shape = "half_space", point = "[0.1, 0, 0] mm", normal = [1, 0, 0] }
[[constraint]]
name = "pulled"
kind = "moved"
velocity = ")" + velocity +
                         R"("
region = { shape = "half_space", point = "[5.5, 0, 0] mm", normal = [-1, 0, 0] }
[run]
)" + run,
                     "bar.toml");
}

const WidthReason& reason(const std::vector<WidthReason>& reasons, const std::string& key) {
  for (const WidthReason& r : reasons)
    if (r.key == key) return r;
  throw std::out_of_range(key);
}

// Off by so much of itself, in the plan's integers.
double error_of(const Vec3& real, const Int3& fixed, double unit) {
  return (Vec3(static_cast<double>(fixed[0]), static_cast<double>(fixed[1]), static_cast<double>(fixed[2])) *
              unit -
          real)
             .norm() /
         real.norm();
}

TEST(AutoWidths, ImposedVelocitiesAndGravityAreRightToTheAccuracy) {
  int met = 0;
  for (const char* velocity : {"[1, 0, 0] um/s", "[5, 0, 0] mm/s", "[0.3, 0.4, 0] m/s", "[50, 0, 0] m/s"})
    for (const double accuracy : {1e-1, 1e-3, 1e-4}) {
      const Scene scene = drawn_bar(velocity, fmt::format("steps = 20000\naccuracy = {}\n", accuracy),
                                    "gravity = \"[0, 0, -9.81] m/s^2\"\n");
      const Plan plan = plan_of(scene, {});
      const double unit = std::ldexp(plan.rule.cell_edge, -plan.rule.widths.velocity_frac()) / scene.rule.dt;
      const bool capped = reason(plan.reasons, "guard").wanted > plan.rule.widths.guard;
      if (capped) continue;
      for (size_t k = 0; k < plan.rule.types.size(); ++k) {
        const ParticleType& type = scene.rule.types[k];
        if (type.velocity.norm() > 0) {
          EXPECT_LE(error_of(type.velocity, plan.rule.types[k].velocity, unit), accuracy);
          ++met;
        }
        EXPECT_LE(error_of(type.gravity, plan.rule.types[k].gravity, unit / scene.rule.dt), accuracy);
      }
    }
  EXPECT_GE(met, 4);
}

// One end at 5 mm/s for 20,000 steps of 36.9 ns: 3.69 um of 6 mm.
TEST(AutoWidths, TheExpectedStrainHasItsUnits) {
  const Scene scene = drawn_bar("[5, 0, 0] mm/s", "steps = 20000\n");
  const Motion motion = motion_of(scene);
  const double length = 5.5 * 0.7071067811865476e-3 + 1.5 * 0.7071067811865476e-3 + 0.7071067811865476e-3;
  EXPECT_NEAR(motion.strain, 5e-3 * 20000 * scene.rule.dt / length, 0.05 * motion.strain);
  EXPECT_EQ(motion.strain_of, "the velocity imposed on 'matter/pulled'");
  const Plan plan = plan_of(scene, {});
  const double strain = motion.strain * motion.rest_distance / plan.rule.cell_edge;
  const Widths& w = plan.rule.widths;
  EXPECT_GE(std::ldexp(strain, w.difference_frac), 1000);
  EXPECT_LT(std::ldexp(strain, w.difference_frac), 2000);  // and no bit more
  EXPECT_GE(w.position_frac, w.difference_frac);
  // A unit of a difference kicks by 16 units of a velocity.
  const double kick = motion.bond_stiffness * scene.rule.dt * scene.rule.dt / scene.rule.mass;
  EXPECT_GE(std::ldexp(kick, w.velocity_frac() - w.difference_frac), 16);
  EXPECT_TRUE(plan.warnings.empty());
}

// A wave carries V/c before it has crossed the body.
TEST(AutoWidths, AFastPullStrainsByAWave) {
  const Scene scene = drawn_bar("[20, 0, 0] m/s", "steps = 3\n");
  const Motion motion = motion_of(scene);
  const double c = 0.5e-3 * std::sqrt(motion.bond_stiffness / scene.rule.mass);
  EXPECT_DOUBLE_EQ(motion.sound_speed, c);
  EXPECT_DOUBLE_EQ(motion.strain, 20 / c);
  // k = (3/(2 sqrt 2)) E pitch along [100].
  EXPECT_NEAR(motion.bond_stiffness, 3 / (2 * std::sqrt(2.0)) * 3e9 * 0.5e-3, 1e-6 * motion.bond_stiffness);
}

// A body that turns is strained by (V/c)^2, one that is hot by V/c, one that flies not at all.
TEST(AutoWidths, WhatInitialMotionStrains) {
  const auto moving = [](const std::string& velocity) {
    return motion_of(parse_scene(R"(
units = "reduced"
mass = 1.0
[packing]
pitch = 1.0
[box]
cells = [4, 4, 4]
[law]
kind = "elastic"
stiffness = 1.0
[[velocity]]
)" + velocity + "\n[run]\nsteps = 10\n",
                                 "hot.toml"));
  };
  const Motion flying = moving("uniform = [0.01, 0, 0]"), turning = moving("spin = [0, 0, 0.001]"),
               hot = moving("thermal_speed = 0.01\nseed = 1");
  EXPECT_EQ(flying.strain, 0);
  EXPECT_NEAR(flying.initial_speed, 0.01, 1e-12);
  EXPECT_NEAR(hot.strain, std::sqrt(3.0) * 0.01, 0.1 * hot.strain);  // c = 1; three components
  EXPECT_NEAR(turning.strain, turning.initial_speed * turning.initial_speed, 1e-9 * turning.strain);
  EXPECT_EQ(turning.strain_of, "the initial rotation");
}

TEST(AutoWidths, LargeStrainsTakeTheLeast) {
  const Plan plan = plan_of(read_scene(std::string(CUBOCT_SOURCE_DIR) + "/scenes/coupon.toml"), {});
  const Widths& w = plan.rule.widths;
  EXPECT_EQ(w.position_frac, 20);
  EXPECT_EQ(w.guard, 8);
  EXPECT_EQ(w.difference_frac, 16);
  EXPECT_EQ(w.velocity_bits, 29);
  EXPECT_EQ(w.relative_velocity_frac, 20);
  EXPECT_EQ(w.relative_velocity_bits, 18);
  EXPECT_EQ(w.strength_bits, 18);
  EXPECT_EQ(w.sum_bits, 29);
  EXPECT_EQ(w.gain_frac, 16);
  EXPECT_EQ(plan.arch.capacity, 16);
}

TEST(AutoWidths, WhatTheArchSaysWinsAndIsWarnedOf) {
  const Scene scene = drawn_bar("[5, 0, 0] mm/s", "steps = 20000\n");
  Arch arch;
  arch.widths.difference_frac = 14;
  const Plan plan = plan_of(scene, arch);
  EXPECT_EQ(plan.rule.widths.difference_frac, 14);
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_EQ(plan.warnings[0],
            "a strain of 0.0007, by the velocity imposed on 'matter/pulled', has 8.1 units of a difference: "
            "difference_frac = 21 would do, or \"auto\"");
  const WidthReason& r = reason(plan.reasons, "difference_frac");
  EXPECT_TRUE(r.asked);
  EXPECT_EQ(r.wanted, 21);
}

// Of what damping sees, and of what bounds a width that the arch leaves to us; the numbers that are named
// work.
TEST(AutoWidths, WarningsNameTheKeyThatBounds) {
  const Scene scene = drawn_bar("[5, 0, 0] mm/s", "steps = 20000\n", "damping.ratio = 0.1\n");
  EXPECT_TRUE(plan_of(scene, {}).warnings.empty());
  const auto warning = [&](auto set) {
    Arch arch;
    set(arch.widths);
    const std::vector<std::string> warnings = plan_of(scene, arch).warnings;
    return warnings.size() == 1 ? warnings[0].substr(warnings[0].find(": ") + 2)
                                : fmt::format("{} warnings", warnings.size());
  };
  EXPECT_EQ(warning([](Widths& w) { w.relative_velocity_frac = 6; }),
            "relative_velocity_frac = 24 would do, or \"auto\"");
  EXPECT_EQ(warning([](Widths& w) { w.relative_velocity_bits = 6; }),
            "relative_velocity_bits = 22 would do, or \"auto\"");
  EXPECT_EQ(warning([](Widths& w) { w.relative_velocity_bits = 22; }), "0 warnings");
  EXPECT_EQ(warning([](Widths& w) { w.position_frac = 12; }), "position_frac = 26 would do, or \"auto\"");
  EXPECT_EQ(warning([](Widths& w) { w.position_frac = 26; }), "0 warnings");
}

// A cantilever's largest strain by Euler and Bernoulli is 3 rho g l^2 / (E h); c^2 is E/rho to within a
// factor of two.
TEST(AutoWidths, GravityBendsWhatReachesOut) {
  const Scene scene = parse_scene("gravity = \"[0, 0, -9.81] m/s^2\"\n" + kBar + R"([[constraint]]
name = "fixed"
kind = "held"
region = { shape = "half_space", point = "[0.1, 0, 0] mm", normal = [1, 0, 0] }
[run]
steps = 1000000
)",
                                  "cantilever.toml");
  const Motion motion = motion_of(scene);
  const double beam = 3 * 1410 * 9.81 * std::pow(6e-3, 2) / (3e9 * 1.5e-3);
  EXPECT_EQ(motion.strain_of, "gravity, which bends it");
  EXPECT_GT(motion.strain, 0.5 * beam);
  EXPECT_LT(motion.strain, 2 * beam);
}

// The widths that a refusal names work.
TEST(AutoWidths, ARefusalNamesWidthsThatHold) {
  const Scene scene = drawn_bar("[1, 0, 0] um/s", "steps = 20000\n");
  Arch arch;
  arch.widths.position_frac = 20;
  arch.widths.guard = 8;
  std::string said;
  try {
    plan_of(scene, arch);
  } catch (const InputError& error) {
    said = error.what();
  }
  int position = 0, guard = 0;
  const size_t hint = said.find("hint: widths that hold it: ");
  ASSERT_NE(hint, std::string::npos) << said;
  EXPECT_EQ(std::sscanf(said.c_str() + hint, "hint: widths that hold it: position_frac = %d, guard = %d",
                        &position, &guard),
            2)
      << said;
  arch.widths.position_frac = position;
  arch.widths.guard = guard;
  EXPECT_NO_THROW(plan_of(scene, arch));
}

// Gains that the usual 16 fractional bits would round by more than the accuracy, and ones that they cannot
// hold.
TEST(AutoWidths, GainsAreRightToTheAccuracy) {
  for (const char* gains : {"kp = \"1e3 N/m\"\nkd = \"1 g/s\"\n", "kp = \"1e5 N/m\"\n"}) {
    const Scene scene = parse_scene(kBar + R"([[constraint]]
name = "led"
kind = "held_by_force"
region = { shape = "half_space", point = "[0.1, 0, 0] mm", normal = [1, 0, 0] }
)" + gains + "[run]\nsteps = 10\naccuracy = 0.01\n",
                                    "gains.toml");
    const Plan plan = plan_of(scene, {});
    for (size_t k = 0; k < plan.rule.types.size(); ++k) {
      const ParticleType& type = scene.rule.types[k];
      if (!type.pd) continue;
      const double unit = std::ldexp(1.0, -plan.rule.widths.gain_frac),
                   step = scene.rule.dt / scene.rule.mass;
      EXPECT_NEAR(static_cast<double>(plan.rule.types[k].kp) * unit / (type.kp * step * scene.rule.dt), 1,
                  0.01);
      if (type.kd > 0) {
        EXPECT_NEAR(static_cast<double>(plan.rule.types[k].kd) * unit / (type.kd * step), 1, 0.01);
      }
    }
  }
}

// A warm crystal in a box whose cells are a little longer than the cutoff: planes of sites near faces come
// in.
TEST(AutoWidths, ACellHoldsWhatComesIn) {
  Scene scene = read_scene(std::string(CUBOCT_SOURCE_DIR) + "/scenes/validation/crystal.toml");
  const cuboct::Setup setup = make_setup(scene, {});
  uint32_t fullest = 0;
  std::vector<uint32_t> count(setup.plan.lattice.size());
  for (const Particle& p : setup.initial.particles) fullest = std::max(fullest, ++count[p.cell]);
  EXPECT_EQ(fullest, 32u);
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  EXPECT_NO_THROW({
    for (int k = 0; k < 120; ++k) golden.step();
  });
  Arch tight;
  tight.capacity = static_cast<int>(fullest);
  const cuboct::Setup full = make_setup(scene, tight);
  Golden stopped(full.plan.rule, full.plan.lattice, tight.capacity, full.initial);
  EXPECT_THROW(
      {
        for (int k = 0; k < 120; ++k) stopped.step();
      },
      RunError);
}

}  // namespace
}  // namespace cuboct
