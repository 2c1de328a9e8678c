// SPDX-License-Identifier: MIT
// Materials that only touch: they push within the contact distance and part from there on.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "hw/plan/setup.h"
#include "model/contract/golden.h"
#include "model/contract/law.h"
#include "model/real/reference.h"
#include "tests/support/block.h"

namespace cuboct {
namespace {

// Force 3 - r in N up to r = 4 m, where it is cut: a spring of 1 N/m that pulls beyond 3 m.
constexpr double kRest = 3, kGap = 0.5, kSpeed = 0.5;
std::shared_ptr<const PairLaw> spring() {
  return spline_law({0.5, 4}, {2.5, -1}, Interpolation::monotone_cubic, 0.5);
}

// A particle of 1 kg flies towards a held one of another material, with which it only touches.
Scene bounce(double damping) {
  Scene scene;
  scene.path = "bounce";
  Rule& rule = scene.rule;
  rule.law = spring();
  rule.mass = 1;
  rule.dt = 0.01;
  rule.damping.coefficient = damping;
  rule.types = {{.name = "ball"}, {.name = "plate", .material = 1, .imposed = {true, true, true}}};
  rule.strength = {{1, 1}, {1, 1}};
  rule.contact = {{0, 1}, {1, 0}};
  rule.contact_distance = push_end(*rule.law);
  scene.body.x = {Vec3(kRest + kGap, 0, 0), Vec3::Zero()};
  scene.body.v = {Vec3(-kSpeed, 0, 0), Vec3::Zero()};
  scene.body.type = {0, 1};
  scene.reach_margin = Vec3::Constant(4);
  scene.steps = 600;
  return scene;
}

// In contact the ball swings on a spring: half a period, pi sqrt(m/k), and it leaves as fast as it came.
double expected_place(double time) { return kRest + kSpeed * (time - kGap / kSpeed - std::numbers::pi); }

TEST(Contact, EndsWhereTheLawEndsToPush) {
  EXPECT_NEAR(push_end(*spring()), kRest, 1e-12);
  EXPECT_NEAR(push_end(*lennard_jones(2, 0.3, 1, 0.2)), 0.3 * std::pow(2, 1.0 / 6), 1e-13);
  EXPECT_NEAR(push_end(*preset_law("ductile", 1e-3, 5)), 1e-3, 1e-15);
  const auto push = spline_law({0.5, 4}, {2.5, 0}, Interpolation::monotone_cubic, 0.5);
  EXPECT_EQ(push_end(*push), 4);
}

TEST(Contact, ReboundInDoublesIsThatOfASpring) {
  const Scene scene = bounce(0);
  Reference run(scene.rule, scene.body, {});
  EXPECT_EQ(run.potential_energy(), 0);
  run.step(100);
  EXPECT_NEAR(run.body().x[0].x(), kRest, 1e-12);
  run.step(157);  // a quarter of a period: at rest, 0.5 m inside
  EXPECT_NEAR(run.potential_energy(), 0.5 * kSpeed * kSpeed, 1e-4);
  run.step(343);
  // The step's error of the period is (omega dt)^2/24 of it, and the way in and out is a step at most each.
  EXPECT_NEAR(run.body().x[0].x(), expected_place(6), 2 * scene.rule.dt * kSpeed);
  EXPECT_NEAR(run.body().v[0].x(), kSpeed, 0.01 * kSpeed);
  EXPECT_EQ(run.potential_energy(), 0);
}

TEST(Contact, ReboundInIntegersIsThatOfDoubles) {
  for (const double damping : {0.0, 0.3}) {
    const Scene scene = bounce(damping);
    const auto setup = make_setup(scene, {});
    const FixedRule& rule = setup.plan.rule;
    ASSERT_TRUE(rule.scaled);
    EXPECT_GT(rule.contact2, 0u);
    Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
    for (int step = 0; step < 600; ++step) golden.step();
    Reference run(scene.rule, scene.body, {});
    run.step(600);
    const Body body = to_real(golden.state(), rule, setup.plan.lattice, setup.plan.origin);
    // Without cohesion damping alone slows the ball, which is gone in the end.
    EXPECT_GT(body.x[0].x(), kRest + 0.2);
    EXPECT_NEAR(body.x[0].x(), run.body().x[0].x(), 1e-3);
    EXPECT_NEAR(body.v[0].x(), run.body().v[0].x(), 1e-3);
    EXPECT_LT(body.v[0].x(), damping > 0 ? 0.9 * kSpeed : 1.01 * kSpeed);
  }
}

// Below the contact distance a pair that touches has the kick of one that does not, to the last bit.
TEST(Contact, KicksAreThoseOfTheLawOrNone) {
  Scene scene = test::block_scene({.damping = 0.15, .two_materials = true, .contact = true});
  const FixedRule touch = quantise(scene.rule, 1.7, {}, {});
  scene.rule.contact.clear();
  const FixedRule bond = quantise(scene.rule, 1.7, {}, {});
  EXPECT_EQ(touch.scale[0][1], -bond.scale[0][1]);
  EXPECT_EQ(touch.scale[0][0], bond.scale[0][0]);
  const auto contact2 =
      static_cast<double>(touch.contact2) * std::ldexp(1, -2 * touch.widths.difference_frac);
  EXPECT_NEAR(std::sqrt(contact2) * 1.7, 1, 1e-6);
  std::mt19937_64 random(3);
  const int64_t P = int64_t{1} << touch.widths.position_frac;
  int pushes = 0, parted = 0;
  for (int k = 0; k < 100000; ++k) {
    Int3 xi, xj, vi, vj;
    for (int a = 0; a < 3; ++a) {
      xi[a] = static_cast<int64_t>(random() % P), xj[a] = static_cast<int64_t>(random() % P);
      vi[a] = static_cast<int64_t>(random() % 4096), vj[a] = static_cast<int64_t>(random() % 4096);
    }
    const PairResult as_bond = pair_kick(bond, xi, vi, 0, xj, vj, 1),
                     back = pair_kick(touch, xj, vj, 1, xi, vi, 0);
    const PairResult own = pair_kick(touch, xi, vi, 0, xj, vj, 1);
    const Int3 d = difference(touch, xi, xj);
    const bool near = static_cast<uint64_t>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) < touch.contact2;
    ASSERT_EQ(own.inside, near);
    ASSERT_EQ(back.inside, near);
    for (int a = 0; a < 3; ++a) {
      ASSERT_EQ(own.kick[a], near ? as_bond.kick[a] : 0);
      ASSERT_EQ(back.kick[a], -own.kick[a]);
    }
    pushes += near, parted += !near && as_bond.inside;
  }
  EXPECT_GT(pushes, 10000);
  EXPECT_GT(parted, 10000);
}

}  // namespace
}  // namespace cuboct
