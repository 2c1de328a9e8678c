// SPDX-License-Identifier: MIT
// The parts of the watch: the stability quotient against closed forms, and detectors fed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "hw/plan/setup.h"
#include "model/analysis/expected_strain.h"
#include "model/analysis/measure.h"
#include "model/analysis/unstable.h"
#include "model/analysis/watch.h"
#include "model/contract/golden.h"
#include "model/contract/law.h"
#include "tests/fcc_block.h"

namespace cuboct {
namespace {

const std::string kRoot = CUBOCT_SOURCE_DIR;

// f = 0 and slope -3 at r = 1, cutoff 2, mass 2.
Rule spring(double dt) {
  return test::simple_rule(
      spline_law({0.4, 1.0, 1.6, 2.0}, {1.8, 0.0, -1.8, 0.0}, Interpolation::monotone_cubic, 0.4), 2.0, dt);
}

double slope_at_rest(const Rule& rule) { return -rule.law->slope(1.0); }

// Two particles on a bond of stiffness k: the mode in which they part has K = 2 k/m; across it, at rest, 0.
TEST(StabilityQuotient, OfABondIsItsFrequency) {
  const Rule rule = spring(0.7);
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}};
  const std::vector<uint8_t> type{0, 0};
  const double pull = rule.law->force(1.0);
  ASSERT_LT(std::abs(pull), 1e-12);
  const Quotient q = stability_quotient(rule, {}, x, type, {{1, 0.3, 0}, {-0.5, 0.1, 0}});
  EXPECT_NEAR(q.law, 0.7 * 0.7 * 2 * slope_at_rest(rule) / 2.0, 1e-6);
  EXPECT_EQ(q.damping, 0);
  EXPECT_EQ(q.hold, 0);
  EXPECT_NEAR(q.stable_dt(0.7), 2 / std::sqrt(2 * slope_at_rest(rule) / 2.0), 1e-6);
}

// Damping adds 2 dt times 2 c/m, a controller dt^2 kp/m + 2 dt kd/m; an imposed particle has no say.
TEST(StabilityQuotient, AddsDampingAndControllers) {
  Rule rule = spring(0.5);
  rule.damping.coefficient = 0.8;
  const double c = rule.damping_over_r2(1.0), k = slope_at_rest(rule);
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0}};
  Quotient q = stability_quotient(rule, {}, x, std::vector<uint8_t>{0, 0}, {{1, 0, 0}, {-1, 0, 0}});
  EXPECT_NEAR(q.law, 0.25 * k, 1e-9);
  EXPECT_NEAR(q.damping, 2 * 0.5 * 2 * c / 2.0, 1e-9);
  // At its own dt the quotient is 4.
  const double dt = q.stable_dt(0.5);
  EXPECT_NEAR(dt * dt * k + 2 * dt * c, 4, 1e-9);

  rule.types.resize(2, rule.types[0]);
  rule.types[1].imposed = {true, true, true};
  rule.types[0].pd = true;
  rule.types[0].kp = 7;
  rule.types[0].kd = 3;
  q = stability_quotient(rule, {}, x, std::vector<uint8_t>{0, 1}, {{1, 0, 0}, {-1, 0, 0}});
  EXPECT_NEAR(q.law, 0.25 * k / 2, 1e-9);
  EXPECT_NEAR(q.damping, 2 * 0.5 * c / 2, 1e-9);
  EXPECT_NEAR(q.hold, (0.25 * 7 + 2 * 0.5 * 3) / 2, 1e-9);
  EXPECT_EQ(q.particle, 0u);
}

// A quotient is at most the largest eigenvalue: (dt/limit)^2 4 in the perfect packing, whatever it starts
// from. From kicks it comes near.
TEST(StabilityQuotient, IsAtMostThatOfThePacking) {
  const Rule rule = test::simple_rule(preset_law("elastic", 1, 1), 1, 0.7);
  const Body block = test::fcc_block(3, 1);
  const double largest = 0.49 * 8;  // omega_max^2 = 8 k/m
  std::mt19937_64 generator(5);
  for (int n = 0; n < 20; ++n) {
    std::vector<Vec3> y;
    for (size_t i = 0; i < block.size(); ++i) y.push_back(test::random_vector(generator));
    const Quotient q = stability_quotient(rule, test::fcc_box(3, 1), block.x, block.type, y);
    EXPECT_LT(q.total(), largest * (1 + 1e-9));
    EXPECT_GT(q.total(), 0.8 * largest);
  }
}

// The closest pair by brute force, with any number of threads.
TEST(ClosestPair, IsThatOfAllPairs) {
  const Scene scene = read_scene(kRoot + "/scenes/hot_cluster.toml");
  const auto setup = make_setup(scene, {});
  const Plan& plan = setup.plan;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, setup.initial);
  for (int n = 0; n < 50; ++n) golden.step();
  const State state = golden.state();
  const Body body = to_real(state, plan.rule, plan.lattice, plan.origin);
  ClosestPair expected;
  for (uint32_t i = 0; i < body.size(); ++i)
    for (uint32_t j = i + 1; j < body.size(); ++j)
      if (const double r = (body.x[i] - body.x[j]).norm(); r < expected.r) expected = {i, j, r};
  const auto kicks = summed_kicks(plan.rule, plan.lattice, state);
  for (const int threads : {1, 3}) {
    ClosestPair closest;
    energies(scene.rule, plan.rule, plan.lattice, plan.origin, state, kicks, threads, &closest);
    EXPECT_EQ(closest.i, expected.i);
    EXPECT_EQ(closest.j, expected.j);
    EXPECT_NEAR(closest.r, expected.r, 1e-12);
  }
}

// A coherent swing at 0.2 of the limit turns over as a whole at its end: suspicious, but no failure. The same
// flips with a step beyond the limit are one.
TEST(Watch, TakesTheEndOfASwingForNoFailure) {
  for (const bool beyond : {false, true}) {
    Scene scene;
    scene.rule = test::simple_rule(preset_law("elastic", 1, 1), 1, beyond ? 1.0 : 0.2 * 2 / std::sqrt(8.0));
    scene.body = test::fcc_block(3, 1);
    scene.pitch = 1;
    scene.dt_limit = 2 / std::sqrt(8.0);
    Watch watch(scene, 0);
    Moment moment;
    moment.x = [&](uint32_t id) { return scene.body.x[id]; };
    moment.v = [&](uint32_t id) { return Vec3(id % 2 ? 0.1 : -0.1, 0, 0); };
    moment.v_next = [&](uint32_t id) { return Vec3(id % 2 ? -0.11 : 0.11, 0, 0); };
    moment.force = [](uint32_t) { return Vec3::Zero(); };
    moment.energies = {1, -1, 0};
    watch.see(moment);
    ASSERT_EQ(watch.findings().size(), beyond ? 1u : 0u);
    if (beyond) {
      EXPECT_EQ(watch.findings()[0].failure, Failure::time_step);
      EXPECT_GT(watch.findings()[0].number, 4);
      EXPECT_LT(watch.findings()[0].number, 8 * (1 + 1e-9));
    }
  }
}

// A row of five bonds of stiffness 3, its end led by 0.02: each stretches by 0.004 and holds 3 0.004^2/2.
TEST(ExpectedStrain, OfARowIsThatOfSprings) {
  Scene scene;
  scene.rule = spring(0.1);
  scene.rule.types.resize(3, scene.rule.types[0]);
  scene.rule.types[1].imposed = scene.rule.types[2].imposed = {true, true, true};
  scene.rule.types[2].velocity = {0.002, 0, 0};
  for (int i = 0; i < 6; ++i) scene.body.x.emplace_back(i, 0, 0);
  const std::vector<uint8_t> type{1, 0, 0, 0, 0, 2};
  const double k = slope_at_rest(scene.rule);
  const ExpectedStrain strain = expected_strain(scene, scene.body.x, type, 10);
  EXPECT_NEAR(strain.stretch, 0.004, 1e-9);
  EXPECT_NEAR(strain.energy, 5 * 0.5 * k * 0.004 * 0.004, 1e-9);
  // Nothing strains what is led as a whole, nor what falls with nothing to hold it.
  EXPECT_EQ(expected_strain(scene, scene.body.x, std::vector<uint8_t>{0, 0, 0, 0, 0, 2}, 10).stretch, 0);
  for (ParticleType& t : scene.rule.types) t.gravity = {0.1, 0, 0};
  EXPECT_EQ(expected_strain(scene, scene.body.x, std::vector<uint8_t>(6, 0), 10).stretch, 0);
  // Hung up at one end, the bond there carries the weight of five particles of mass 2.
  EXPECT_NEAR(expected_strain(scene, scene.body.x, std::vector<uint8_t>{1, 0, 0, 0, 0, 0}, 10).stretch,
              5 * 2 * 0.1 / k, 1e-9);
}

// A block with one end held and the other led, by golden, with so many guard bits. `thrown`: m/s, of all that
// is free.
std::vector<Finding> found_in_a_pull(double speed, int guard, uint64_t steps, double thrown = 0) {
  Scene scene;
  scene.rule = test::simple_rule(preset_law("elastic", 1, 1), 1, 0.1);
  scene.body = test::fcc_block(3, 1);
  scene.pitch = 1;
  scene.steps = steps;
  scene.rule.types.resize(3, scene.rule.types[0]);
  scene.rule.types[1].imposed = scene.rule.types[2].imposed = {true, true, true};
  scene.rule.types[2].velocity = {speed, 0, 0};
  double end = 0;
  for (const Vec3& x : scene.body.x) end = std::max(end, x.x());
  for (uint32_t id = 0; id < scene.body.size(); ++id)
    scene.body.type[id] = scene.body.x[id].x() < 0.8 ? 1 : scene.body.x[id].x() > end - 0.8 ? 2 : 0;
  for (uint32_t id = 0; id < scene.body.size(); ++id)
    if (scene.body.type[id] == 0) scene.body.v[id].x() = thrown;
  Arch arch;
  arch.widths.position_frac = 20;
  arch.widths.guard = guard;
  arch.widths.difference_frac = 16;
  const Setup setup = make_setup(scene, arch);
  const Plan& plan = setup.plan;
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, setup.initial);
  Watch watch(scene, 0);
  for (uint64_t step = 0; step <= steps; step += 10) {
    while (golden.step_count() < step) golden.step();
    const State state = golden.state();
    watch.see(plan.rule, plan.lattice, plan.origin, state, summed_kicks(plan.rule, plan.lattice, state), {},
              {});
  }
  watch.conclude();
  return watch.findings();
}

// 62.62 units of 2^-28 cells per step, at a cell edge of sqrt(2), are rounded to 63: 0.6 % too fast. The
// guard bits that the finding names leave nothing to tell.
TEST(Watch, TellsImposedMotionThatIsRounded) {
  const double speed = 62.62 * std::ldexp(std::sqrt(2.0), -28) / 0.1;
  const std::vector<Finding> found = found_in_a_pull(speed, 8, 4000);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].failure, Failure::resolution);
  EXPECT_NEAR(found[0].number, 63 / 62.62 - 1, 1e-4);
  EXPECT_EQ(found[0].limit, 5e-3);
  EXPECT_NE(found[0].text.find("guard = 12 would do"), std::string::npos) << found[0].text;
  EXPECT_TRUE(found_in_a_pull(speed, 12, 4000).empty());
}

// Bonds that are to stretch by 2 units of a difference: told after the last look. A hundred times the speed,
// and bonds stretch by 200.
TEST(Watch, TellsStrainBelowTheUnitOfADifference) {
  const double speed = 64 * std::ldexp(std::sqrt(2.0), -28) / 0.1;
  const std::vector<Finding> found = found_in_a_pull(speed, 8, 500);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].failure, Failure::resolution);
  EXPECT_EQ(found[0].step, 500u);
  EXPECT_NEAR(found[0].number, 2, 1.5);
  EXPECT_NE(found[0].text.find("difference_frac = 2"), std::string::npos) << found[0].text;
  EXPECT_TRUE(found_in_a_pull(100 * speed, 8, 500).empty());
}

// A body thrown against its hold at 2e-5 of the speed of sound, about 1: bonds stretch by a unit.
TEST(Watch, TellsAnImpactBelowResolution) {
  const std::vector<Finding> found = found_in_a_pull(0, 8, 500, -2e-5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].failure, Failure::resolution);
  EXPECT_TRUE(found_in_a_pull(0, 8, 500, -2e-3).empty());
}

// What never moves by itself has nothing to show.
TEST(Watch, IsSilentAboutABodyAtRest) { EXPECT_TRUE(found_in_a_pull(0, 8, 200).empty()); }

// An engine that lost what a velocity has below half a unit of position in each step.
TEST(Watch, TellsADriftThatLosesMotion) {
  Scene scene;
  scene.rule = test::simple_rule(preset_law("elastic", 1, 1), 1, 0.1);
  scene.body = test::fcc_block(2, 1);
  scene.pitch = 1;
  scene.rule.types[0].imposed = {true, true, true};
  scene.rule.types[0].velocity = {1e-3, 0, 0};
  for (const bool lost : {true, false}) {
    Watch watch(scene, 0);
    Moment moment;
    moment.step = 1000;
    moment.x = [&](uint32_t id) -> Vec3 { return scene.body.x[id] + Vec3(lost ? 0.09 : 0.1, 0, 0); };
    moment.v = moment.v_next = [](uint32_t) { return Vec3(1e-3, 0, 0); };
    moment.force = [](uint32_t) { return Vec3::Zero(); };
    watch.see(moment);
    ASSERT_EQ(watch.findings().size(), lost ? 1u : 0u);
    if (lost) {
      EXPECT_NEAR(watch.findings()[0].number, 0.1, 1e-9);
    }
  }
}

TEST(Watch, FindsFloatsTooFarApart) {
  Scene scene;
  scene.pitch = 1;
  scene.rule = test::simple_rule(preset_law("elastic", 1, 1), 1, 0.1);
  scene.body = test::fcc_block(2, 1);
  EXPECT_FALSE(find_far_origin(scene));
  for (Vec3& x : scene.body.x) x.x() += 1e5;
  const auto found = find_far_origin(scene);
  ASSERT_TRUE(found);
  // Beyond 2^16 floats are 2^-7 apart.
  EXPECT_EQ(found->number, std::ldexp(1, -7));
}

}  // namespace
}  // namespace cuboct
