// SPDX-License-Identifier: MIT
// Materials of their own mass, against closed forms: collisions, the reduced mass, the diatomic chain.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "hw/plan/setup.h"
#include "model/analysis/measure.h"
#include "model/analysis/strain.h"
#include "model/analysis/unstable.h"
#include "model/base/fixed_math.h"
#include "model/contract/golden.h"
#include "model/contract/law.h"
#include "model/contract/quantise.h"
#include "model/real/reference.h"
#include "model/scene/scene_parts.h"
#include "model/solid/vibrations.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

// Force 3 - r in N up to r = 4 m, where it is cut: a spring of 1 N/m.
constexpr double kRest = 3, kLight = 1, kHeavy = 3;

// Particles of the two kinds in turn, on a line.
Scene line(int count, double heavy = kHeavy) {
  Scene scene;
  scene.path = "line";
  Rule& rule = scene.rule;
  rule.law = spline_law({0.5, 4}, {2.5, -1}, Interpolation::monotone_cubic, 0.5);
  rule.mass = kLight;
  rule.masses = {kLight, heavy};
  rule.dt = 0.01;
  rule.types = {{.name = "light"}, {.name = "heavy", .material = 1}};
  rule.strength = {{1, 1}, {1, 1}};
  for (int k = 0; k < count; ++k) {
    scene.body.x.emplace_back(k * kRest, 0, 0);
    scene.body.v.push_back(Vec3::Zero());
    scene.body.type.push_back(static_cast<uint8_t>(k % 2));
  }
  scene.reach_margin = Vec3::Constant(4);
  scene.accuracy = 1e-5;
  return scene;
}

Body after(const Scene& scene, uint64_t steps, bool integers) {
  if (!integers) {
    Reference run(scene.rule, scene.body, scene.periodic);
    run.step(steps);
    return run.body();
  }
  Scene lasting = scene;
  lasting.steps = steps;
  const auto setup = make_setup(lasting, {});
  EXPECT_TRUE(setup.plan.rule.weighted);
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  for (uint64_t step = 0; step < steps; ++step) golden.step();
  return to_real(golden.state(), setup.plan.rule, setup.plan.lattice, setup.plan.origin);
}

TEST(Masses, CollideElastically) {
  for (const bool integers : {false, true}) {
    Scene scene = line(2);
    scene.rule.contact = {{0, 1}, {1, 0}};
    scene.rule.contact_distance = push_end(*scene.rule.law);
    scene.body.x[1].x() += 0.5;
    scene.body.v[0].x() = 0.6, scene.body.v[1].x() = -0.2;
    const Body end = after(scene, 800, integers);
    // In the frame of the centre of mass, which is at rest, both turn round. The ends of the contact fall
    // within a step, in which the spring's force, at most dt times its rate, is missed or felt too long.
    EXPECT_NEAR(end.v[0].x(), -0.6, 0.01) << integers;
    EXPECT_NEAR(end.v[1].x(), 0.2, 0.01 / kHeavy) << integers;
    // Of the 1.2 kg m/s that change hands, what the weight's half unit makes of 3 kg.
    EXPECT_NEAR(kLight * end.v[0].x() + kHeavy * end.v[1].x(), 0,
                integers ? 1.2 * kHeavy * std::ldexp(1, -17) : 1e-12);
  }
}

TEST(Masses, SwingWithTheReducedMass) {
  for (const bool integers : {false, true}) {
    Scene scene = line(2);
    scene.body.x[1].x() += 0.4;
    const double period = 2 * std::numbers::pi * std::sqrt(kLight * kHeavy / (kLight + kHeavy));
    const auto steps = static_cast<uint64_t>(std::lround(period / scene.rule.dt));
    const auto half = after(scene, steps / 2, integers), whole = after(scene, steps, integers);
    // Shares of the stretch are as the other's mass; semi-implicit Euler's velocities are half a step behind.
    EXPECT_NEAR(half.x[0].x(), 0.4 * 2 * kHeavy / (kLight + kHeavy), 5e-3) << integers;
    EXPECT_NEAR(half.x[1].x(), kRest + 0.4 - 0.4 * 2 * kLight / (kLight + kHeavy), 5e-3) << integers;
    EXPECT_NEAR(whole.x[0].x(), 0, 1e-3) << integers;
    EXPECT_NEAR(whole.x[1].x(), kRest + 0.4, 1e-3) << integers;
  }
}

// A ring of both in turn: w^2 = k (1/m + 1/M) - k sqrt((1/m + 1/M)^2 - 4 sin^2(q a)/(m M)) of the long waves.
// Kittel, Introduction to Solid State Physics, chapter 4.
TEST(Masses, RingHasTheFrequencyOfTheDiatomicChain) {
  constexpr int kCount = 24;
  Scene scene = line(kCount);
  scene.periodic = {Vec3(-1, 0, 0), Vec3(kCount * kRest, 0, 0)};
  const double qa = 2 * std::numbers::pi / kCount, sum = 1 / kLight + 1 / kHeavy;
  const double w2 = sum - std::sqrt(sum * sum - 4 * std::pow(std::sin(qa), 2) / (kLight * kHeavy));
  const double amplitude = 0.05, of_light = 2 * std::cos(qa) / (2 - kLight * w2);
  for (int k = 0; k < kCount; ++k)
    scene.body.x[k].x() += amplitude * (k % 2 == 0 ? of_light : 1) * std::cos(qa * k);
  const double period = 2 * std::numbers::pi / std::sqrt(w2);
  const auto steps = static_cast<uint64_t>(std::lround(period / scene.rule.dt));
  for (const bool integers : {false, true}) {
    const Body end = after(scene, steps, integers), half = after(scene, steps / 2, integers);
    for (int k = 0; k < kCount; ++k) {
      EXPECT_NEAR(nearest_image(end.x[k] - scene.body.x[k], scene.periodic).x(), 0, 0.01 * amplitude) << k;
      const double place = kRest * k, there = scene.body.x[k].x() - place;
      EXPECT_NEAR(nearest_image(half.x[k] - Vec3(place, 0, 0), scene.periodic).x(), -there, 0.01 * amplitude);
    }
  }
}

TEST(Masses, FallAlike) {
  Scene scene = line(2, 7);
  scene.body.x[1].x() += 2;  // out of reach
  for (ParticleType& type : scene.rule.types) type.gravity = Vec3(0, 0, -0.01);
  for (const bool integers : {false, true}) {
    const Body end = after(scene, 100, integers);
    for (const Vec3& v : end.v) EXPECT_NEAR(v.z(), -0.01, 1e-7) << integers;
  }
}

// Pairs give equal and opposite sums; what each sum adds to v is rounded once.
TEST(Masses, KeepMomentumToARounding) {
  test::Features f{.size = {2, 2, 2}, .jitter = 0.05, .speed = 0.1, .two_materials = true, .masses = true};
  f.margin = 6;
  const auto setup = test::block(f);
  const FixedRule& rule = setup.plan.rule;
  ASSERT_TRUE(rule.weighted);
  Golden golden(rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  for (int step = 0; step < 200; ++step) golden.step();
  const State end = golden.state();
  const Int3 before = momentum(rule, setup.initial), now = momentum(rule, end);
  Int3 plain{};
  for (size_t k = 0; k < end.particles.size(); ++k)
    for (int a = 0; a < 3; ++a) plain[a] += end.particles[k].v[a] - setup.initial.particles[k].v[a];
  // Half a unit each: a standard deviation of sqrt(1/12) of the heavier's, in a random walk. Six of them.
  const double walk = 6 * 2.7 * std::sqrt(200.0 * static_cast<double>(end.particles.size()) / 12);
  for (int a = 0; a < 3; ++a) {
    EXPECT_LT(std::abs(static_cast<double>(now[a] - before[a])), walk);
    EXPECT_GT(std::abs(static_cast<double>(plain[a])), 10 * walk);  // the sum of v alone is not kept
  }
}

TEST(Masses, WeighASumAsTheContractSays) {
  FixedRule rule;
  rule.weighted = true;
  rule.widths.sum_bits = 40;
  rule.types = {{}, {.weight = 21845}, {.weight = 64}};
  std::mt19937_64 random(5);
  for (int k = 0; k < 3000; ++k) {
    const int type = k % 3;
    Int3 sum;
    for (int64_t& s : sum) s = wrap(static_cast<int64_t>(random()), 2 + k % 27);
    const FinishResult result = finish(rule, sum, {}, {}, {}, type);
    ASSERT_EQ(result.fault, Fault::none);
    for (int a = 0; a < 3; ++a)
      ASSERT_EQ(result.v[a], std::llround(std::ldexp(static_cast<double>(sum[a]), -16) *
                                          static_cast<double>(rule.types[type].weight)));
  }
}

TEST(Masses, AreRefusedBeyondTheirRange) {
  const auto weight = [](double ratio) { return quantise(line(2, ratio).rule, 4, {}, {}).types[1].weight; };
  EXPECT_EQ(weight(1024), 64);
  EXPECT_EQ(weight(3), 21845);
  EXPECT_EQ(refused_with([&] { weight(1025); }),
            "a particle of 'heavy' is 1025 times as heavy as the lightest: integers hold at most 1024\n"
            "  hint: doubles hold any (--engine reference)");
}

TEST(Masses, AlikeLeaveTheRuleAsItWas) {
  Scene scene = line(2);
  scene.rule.masses.clear();
  const FixedRule rule = quantise(scene.rule, 4, {}, {});
  EXPECT_FALSE(rule.weighted);
  EXPECT_EQ(mass_of(rule, 1), scene.rule.mass);
}

// The largest frequency of the chain, k (1/m + 1/M) twice, whatever finds it.
TEST(Masses, LimitIsThatOfTheDiatomicChain) {
  constexpr int kCount = 8;
  Scene scene = line(kCount);
  scene.periodic = {Vec3(-1, 0, 0), Vec3(kCount * kRest, 0, 0)};
  scene.rule.dt = 1.2;  // near the limit, so that iterations separate the modes
  const double w2 = 2 * (1 / kLight + 1 / kHeavy);
  const Limit limit = stability_limit(vibrations_of(scene.rule, scene.body, scene.periodic));
  EXPECT_NEAR(limit.frequency * limit.frequency, w2, 1e-4 * w2);
  EXPECT_NEAR(limit.dt, 2 / std::sqrt(w2), 1e-4);
  std::vector<Vec3> start;
  for (int k = 0; k < kCount; ++k) start.emplace_back(k % 2 == 0 ? 1 : -0.5, 0, 0);
  const Quotient q = stability_quotient(scene.rule, scene.periodic, scene.body.x, scene.body.type, start);
  EXPECT_NEAR(q.total(), scene.rule.dt * scene.rule.dt * w2, 1e-3 * q.total());
  // The mode tells the velocities of light and heavy apart as their masses do: m u_m = -M u_M.
  EXPECT_NEAR(q.mode[0].x() * q.mode[1].x(), -q.mode[0].squaredNorm(), 1e-3 * q.mode[0].squaredNorm());
}

// What the packing's limit is taken to be is below that of the body.
TEST(Masses, LimitOfThePackingIsOnTheSafeSide) {
  for (const auto& masses : {std::vector{1.0, 2.7}, std::vector{40.0, 1.0}}) {
    Scene scene = test::block_scene({.size = {4, 2, 2}, .jitter = 0, .two_materials = true});
    scene.rule.masses = masses;
    const double packing = stable_time_step(scene.rule, scene.pitch);
    const double body = stability_limit(vibrations_of(scene.rule, scene.body, scene.periodic)).dt;
    EXPECT_LT(packing, body);
    EXPECT_GT(packing, 0.5 * body);
  }
}

// Every particle has m v^2/2 and the body -m g.x, in doubles and in integers.
TEST(Masses, CountInEnergies) {
  Scene scene = line(2, 7);
  scene.body.v = {Vec3(0.1, 0, 0), Vec3(0, 0.2, 0)};
  for (ParticleType& type : scene.rule.types) type.gravity = Vec3(-0.5, 0, 0);
  const Reference reference(scene.rule, scene.body, scene.periodic);
  EXPECT_DOUBLE_EQ(reference.kinetic_energy(), 0.5 * (0.01 + 7 * 0.04));
  EXPECT_NEAR((reference.momentum() - Vec3(0.1, 1.4, 0)).norm(), 0, 1e-15);
  const auto setup = make_setup(scene, {});
  const Plan& plan = setup.plan;
  const std::vector<Int3> kicks = summed_kicks(plan.rule, plan.lattice, setup.initial, 1);
  const Energies e = energies(scene.rule, plan.rule, plan.lattice, plan.origin, setup.initial, kicks, 1);
  const double late = -0.5 * scene.rule.dt / 2;  // half a step of gravity
  const double kinetic = 0.5 * (std::pow(0.1 + late, 2) + 7 * (0.04 + late * late));
  EXPECT_NEAR(e.kinetic, kinetic, 1e-4 * kinetic);
  EXPECT_NEAR(e.free.kinetic, kinetic, 1e-4 * kinetic);
  EXPECT_NEAR(e.gravity, 0.5 * 7 * kRest, 1e-3);
  EXPECT_NEAR((e.free.velocities - Vec3(0.1 + 8 * late, 1.4, 0)).norm(), 0, 1e-3);
}

}  // namespace
}  // namespace cuboct
