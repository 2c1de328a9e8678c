// SPDX-License-Identifier: MIT
// Rules of rounds in time: the reference engine runs what stands in the place of a rule's law.
#include <gtest/gtest.h>

#include <cmath>

#include "model/base/error.h"
#include "model/real/reference.h"
#include "tests/rules/lps_body.h"

namespace cuboct {
namespace {

// A block whose halves part along x, of bonds that break.
struct Parting {
  Rule rule;
  Body body = test::cubic_block(6, 5, 5);
  explicit Parting(double critical_stretch) {
    LpsMaterial m = test::cubic_material();
    m.critical_stretch = critical_stretch;
    rule.rounds = std::make_shared<LpsRule>(m, simple_cubic_bonds(1, 3));
    rule.rounds_reach = m.horizon;
    rule.mass = 1, rule.dt = 0.05;
    rule.types = {{}};
    rule.strength = {{1}};
    for (size_t i = 0; i < body.size(); ++i) body.v[i] = Vec3(body.x[i][0] > 2.5 ? 0.05 : -0.05, 0, 0.01);
  }
};

Body after(const Parting& of, uint64_t steps, int threads) {
  Reference reference(of.rule, of.body, {}, RealOptions{.threads = threads});
  reference.step(steps);
  return reference.body();
}

TEST(RoundsEngine, NoBitDependsOnThreads) {
  const Parting parting(0.02);
  const Body one = after(parting, 100, 1), three = after(parting, 100, 3);
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one.x[i], three.x[i]) << i;
    EXPECT_EQ(one.v[i], three.v[i]) << i;
  }
}

TEST(RoundsEngine, BondsThatBreakLetTheHalvesGo) {
  const auto width = [](const Body& body) { return body.x.back()[0] - body.x.front()[0]; };
  EXPECT_GT(width(after(Parting(0.02), 1000, 1)), 7);
  EXPECT_LT(width(after(Parting(std::numeric_limits<double>::infinity()), 1000, 1)), 6);
}

// Momentum to rounding; energy swings by the order of the step and comes back.
TEST(RoundsEngine, MomentumAndEnergyAreKept) {
  const Parting whole(std::numeric_limits<double>::infinity());
  Reference reference(whole.rule, whole.body, {}, Integrator::velocity_verlet);
  const Vec3 momentum = reference.momentum();
  const double energy = reference.kinetic_energy() + reference.potential_energy();
  reference.step(500);
  EXPECT_LT((reference.momentum() - momentum).norm(), 1e-12);
  EXPECT_NEAR((reference.kinetic_energy() + reference.potential_energy()) / energy, 1, 1e-2);
}

TEST(RoundsEngine, WhatItHasNotIsRefused) {
  Parting parting(0.02);
  EXPECT_THROW(Reference(parting.rule, parting.body, {}, RealOptions{.precision = Precision::float32}),
               InputError);
  EXPECT_THROW(refuse_rounds(parting.rule, "the lattice engine"), InputError);
  parting.body.v[3] = Vec3(0, std::nan(""), 0);
  Reference lost(parting.rule, parting.body, {});
  EXPECT_THROW(lost.step(2), std::runtime_error);
  parting.rule.damping.coefficient = 1;
  EXPECT_THROW(Reference(parting.rule, parting.body, {}), InputError);
}

}  // namespace
}  // namespace cuboct
