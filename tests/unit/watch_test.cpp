// SPDX-License-Identifier: MIT
// The parts of the watch: the stability quotient against closed forms, and detectors fed by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "hw/setup.h"
#include "model/golden.h"
#include "model/law.h"
#include "model/measure.h"
#include "model/unstable.h"
#include "model/watch.h"
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
