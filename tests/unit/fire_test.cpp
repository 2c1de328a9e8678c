// SPDX-License-Identifier: MIT
// FIRE on minima that are known, and bodies at rest between their constraints.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/base/fire.h"
#include "model/contract/law.h"
#include "model/real/balance.h"
#include "tests/fcc_block.h"

namespace cuboct {
namespace {

// E = sum of k_i (x_i - i)^2/2, curvatures from 1 to 10^4.
TEST(Fire, FindsTheMinimumOfANarrowValley) {
  constexpr int kN = 9;
  Eigen::VectorXd k(kN), rest(kN), x = Eigen::VectorXd::Zero(kN);
  for (int i = 0; i < kN; ++i) k[i] = std::pow(10.0, i / 2.0), rest[i] = i + 1;
  const FireResult result = fire(x,
                                 [&](const Eigen::VectorXd& at, Eigen::VectorXd& f) {
                                   f = k.cwiseProduct(rest - at);
                                   return f.norm() < 1e-9;
                                 },
                                 {.stiffness = 1e4});
  EXPECT_TRUE(result.at_rest);
  EXPECT_LT((x - rest).norm(), 1e-9);
  // Steepest descent at its best step, 2/(k_min + k_max), would take log(10^-10) (k_max/k_min)/2 = 115,000.
  EXPECT_LT(result.evaluations, 5000U);
}

// Rosenbrock's valley, 100 (y - x^2)^2 + (1 - x)^2, which bends; curvatures at the start reach 1,500.
TEST(Fire, FollowsAValleyThatBends) {
  Eigen::VectorXd x(2);
  x << -1.2, 1;
  const FireResult result = fire(x,
                                 [](const Eigen::VectorXd& at, Eigen::VectorXd& f) {
                                   const double across = at[1] - at[0] * at[0];
                                   f[0] = 400 * across * at[0] + 2 * (1 - at[0]);
                                   f[1] = -200 * across;
                                   return f.norm() < 1e-9;
                                 },
                                 {.stiffness = 1500});
  EXPECT_TRUE(result.at_rest);
  EXPECT_NEAR(x[0], 1, 1e-8);
  EXPECT_NEAR(x[1], 1, 1e-8);
}

TEST(Fire, StopsAtItsLimitAndGoesNoFurtherThanItsStep) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(1);
  double farthest = 0, before = 0;
  const FireResult result = fire(x,
                                 [&](const Eigen::VectorXd& at, Eigen::VectorXd& f) {
                                   farthest = std::max(farthest, std::abs(at[0] - before));
                                   before = at[0];
                                   f[0] = 1;  // downhill for ever
                                   return false;
                                 },
                                 {.stiffness = 1, .longest_step = 0.25, .most = 100});
  EXPECT_FALSE(result.at_rest);
  EXPECT_EQ(result.evaluations, 100U);
  EXPECT_NEAR(farthest, 0.25, 1e-12);
}

double largest(const std::vector<Vec3>& forces) {
  double most = 0;
  for (const Vec3& f : forces) most = std::max(most, f.norm());
  return most;
}

struct Cluster {
  std::vector<Vec3> x;
  double energy;
};

// Of Lennard-Jones clusters, epsilon = sigma = 1. D. J. Wales and J. P. K. Doye, J. Phys. Chem. A 101 (1997)
// 5111: 13 particles are an icosahedron with one in its middle, 7 a pentagonal bipyramid.
std::vector<Cluster> clusters() {
  const double g = std::numbers::phi;
  Cluster thirteen{{Vec3::Zero()}, -44.326801};
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g})
      for (const Vec3& x : {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)}) thirteen.x.push_back(0.55 * x);
  Cluster seven{{Vec3(0, 0, 0.6), Vec3(0, 0, -0.6)}, -16.505384};
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * std::numbers::pi * i / 5;
    seven.x.emplace_back(std::cos(angle), std::sin(angle), 0);
  }
  return {thirteen, seven, {{{0, 0, 0}, {1, 0, 0}, {0.5, 0.8, 0}, {0.4, 0.3, 0.9}}, -6}};
}

TEST(Balance, OfLennardJonesClustersIsTheirKnownMinimum) {
  const Rule rule = test::simple_rule(lennard_jones(1, 1, 20, 0.5), 1, 1);
  int at_rest = 0;
  for (const Cluster& cluster : clusters()) {
    Body body;
    body.x = cluster.x;
    body.v.assign(body.size(), Vec3::Zero());
    body.type.assign(body.size(), 0);
    test::shake(body, 0.02, 0, 3);
    Balance balance(rule, body, {}, 1);
    const FireResult result =
        balance.relax([](const std::vector<Vec3>& f) { return largest(f) < 1e-10; }, 5000);
    at_rest += result.at_rest;
    // The truncated law is shifted by U(20) = -6e-8 per pair.
    EXPECT_NEAR(balance.reference().potential_energy(), cluster.energy, 1e-5) << cluster.x.size();
  }
  EXPECT_EQ(at_rest, 3);
}

// A particle hangs by a bond from one that a controller holds: the bond pulls by m g, the controller by 2 m
// g.
TEST(Balance, UnderGravityBondAndControllerCarryTheWeight) {
  constexpr double kPitch = 1e-3, kStiffness = 500, kMass = 1e-3, kG = 10, kp = 2000;
  Rule rule = test::simple_rule(preset_law("elastic", kPitch, kStiffness), kMass, 1);
  rule.types[0].gravity = Vec3(0, 0, -kG);
  rule.types.push_back(rule.types[0]);
  rule.types[1].pd = true;
  rule.types[1].kp = kp;
  rule.types[1].velocity = Vec3(0, 0, 0.5);
  Body body;
  body.x = {Vec3(0, 0, -kPitch), Vec3::Zero()};
  body.v.assign(2, Vec3::Zero());
  body.type = {0, 1};
  Balance balance(rule, body, {}, 1);
  const auto at_rest = [&](const std::vector<Vec3>&) { return balance.unbalance().within(1e-9); };
  EXPECT_TRUE(balance.relax(at_rest, 5000).at_rest);
  const double sag = 2 * kMass * kG / kp;
  EXPECT_NEAR(balance.body().x[1].z(), -sag, 1e-7 * sag);
  EXPECT_NEAR(rule.law->force((balance.body().x[1] - balance.body().x[0]).norm()), -kMass * kG,
              1e-7 * kMass * kG);
  EXPECT_NEAR(balance.unbalance().load, 2 * kMass * kG, 1e-7 * kMass * kG);
  // The anchor rises by 10 um, and the body with it; the second time it starts where it goes.
  uint64_t before = 0;
  for (int k = 1; k <= 2; ++k) {
    balance.go_on(2e-5);
    const FireResult result = balance.relax(at_rest, 5000);
    EXPECT_TRUE(result.at_rest);
    EXPECT_NEAR(balance.body().x[1].z(), k * 1e-5 - sag, 1e-9 * kPitch);
    EXPECT_NEAR(balance.body().u[1].z(), -sag, 1e-7 * sag);
    if (k == 2) {
      EXPECT_LT(10 * result.evaluations, before);
    }
    before = result.evaluations;
  }
}

// What is imposed stays where it is put, whatever pulls; its load is what the bond carries.
TEST(Balance, ImposedAxesGoWhereTheyAreTaken) {
  constexpr double kPitch = 1, kStiffness = 3;
  Rule rule = test::simple_rule(preset_law("elastic", kPitch, kStiffness), 1, 1);
  rule.types.resize(3, rule.types[0]);
  rule.types[1].imposed = rule.types[2].imposed = {true, true, true};
  rule.types[2].velocity = Vec3(0.01, 0, 0);
  Body body;
  body.x = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
  body.v.assign(3, Vec3::Zero());
  body.type = {1, 0, 2};
  Balance balance(rule, body, {}, 1);
  balance.go_on(2);
  EXPECT_TRUE(balance.relax([&](const std::vector<Vec3>&) { return balance.unbalance().within(1e-8); }, 5000)
                  .at_rest);
  EXPECT_EQ(balance.body().x[0], Vec3::Zero());
  EXPECT_EQ(balance.body().x[2], Vec3(2.02, 0, 0));
  EXPECT_NEAR(balance.body().x[1].x(), 1.01, 1e-9);
  EXPECT_NEAR(balance.unbalance().load, -rule.law->force(1.01), 1e-9);
}

}  // namespace
}  // namespace cuboct
