// SPDX-License-Identifier: MIT
#include "model/real/reference.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "model/base/error.h"
#include "model/contract/law.h"
#include "model/solid/dynamical_matrix.h"
#include "tests/fcc_block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using enum Integrator;

// Force 3 - r in N up to r = 4 m, where it is cut.
std::shared_ptr<const PairLaw> line() {
  return spline_law({0.5, 4}, {2.5, -1}, Interpolation::monotone_cubic, 0.5);
}

Body two(double distance) {
  Body body;
  body.x = {Vec3(1, 1, 1), Vec3(1 + distance, 1, 1)};
  body.v = {Vec3(0.5, 0, 0), Vec3(-0.25, 1, 0)};
  body.type = {0, 1};
  return body;
}

Rule two_types() {
  Rule rule = test::simple_rule(line(), 2.0, 0.125);
  rule.types.push_back({.name = "other", .material = 1});
  rule.strength = {{1, 0.5}, {0.5, 1}};
  return rule;
}

// Two particles at 2 m: force 1 N times the strength 0.5; damping c = 3 (1 - (2/4)^2)^2 = 27/16 kg/s on the
// radial velocity -0.75 m/s, times 0.5: together 0.5 * (1 + 27/16 * 0.75) N apart.
constexpr double kPush = 0.5 * (1 + 27.0 / 16 * 0.75);

TEST(Reference, PairForceByHand) {
  Rule rule = two_types();
  rule.damping.coefficient = 3;
  const Reference run(rule, two(2), {}, semi_implicit_euler);
  EXPECT_DOUBLE_EQ(run.forces()[0].x(), -kPush);
  EXPECT_DOUBLE_EQ(run.forces()[1].x(), kPush);
  EXPECT_EQ(run.forces()[1].y(), 0);  // only the radial velocity is damped
  EXPECT_DOUBLE_EQ(run.potential_energy(), 0.5 * (3 * 4 - 8 - (3 * 2 - 2)));  // integral of 3 - r from 2 to 4
  EXPECT_DOUBLE_EQ(run.kinetic_energy(), 0.25 + 1.0625);
  EXPECT_EQ(run.momentum(), Vec3(0.5, 2, 0));
  const auto stress = run.virial_stress(5);
  EXPECT_DOUBLE_EQ(stress[0](0, 0), -kPush * 2 / 10);
  EXPECT_EQ(stress[0], stress[1]);
}

TEST(Reference, DampingKeepsItsCoreValueBelowTheCore) {
  Rule rule = two_types();
  rule.damping.coefficient = 3;
  const Reference run(rule, two(0.25), {}, semi_implicit_euler);
  // Law: slope 2.5/0.5 below 0.5 m. Damping over r^2 at the core, times w.d = -0.75 * 0.25, times d = 0.25.
  const double q2 = 0.5 * 0.5 / 16;
  const double damp = 3 * (1 - q2) * (1 - q2) / 0.25;
  EXPECT_DOUBLE_EQ(run.forces()[1].x(), 0.5 * (5 * 0.25 + damp * 0.75 * 0.25 * 0.25));
}

TEST(Reference, EulerStepByHand) {
  Rule rule = two_types();
  rule.damping.coefficient = 3;
  rule.types[0].gravity = Vec3(0, 0, -8);
  rule.types[0].pd = true;
  rule.types[0].velocity = Vec3(0.25, 0, 0);
  rule.types[0].kp = 6;
  rule.types[0].kd = 4;
  rule.types[1].imposed = {false, true, false};
  rule.types[1].velocity = Vec3(9, -3, 9);
  Body body = two(2);
  body.u = {Vec3(0.5, 0, 0), Vec3(7, 7, 7)};
  Reference run(rule, body, {}, semi_implicit_euler);
  run.step();
  // PD: -(6 * 0.5 + 4 * (0.5 - 0.25)) = -4 N, from u and v before the kick.
  const double vx = 0.5 + (-kPush - 4) / 2 * 0.125;
  EXPECT_DOUBLE_EQ(run.body().v[0].x(), vx);
  EXPECT_DOUBLE_EQ(run.body().v[0].z(), -1);
  EXPECT_DOUBLE_EQ(run.body().u[0].x(), 0.5 + (vx - 0.25) * 0.125);
  EXPECT_DOUBLE_EQ(run.body().u[0].z(), -0.125);
  EXPECT_DOUBLE_EQ(run.body().x[0].x(), 1 + vx * 0.125);
  EXPECT_DOUBLE_EQ(run.body().v[1].x(), -0.25 + kPush / 2 * 0.125);
  EXPECT_EQ(run.body().v[1].y(), -3);
  EXPECT_DOUBLE_EQ(run.body().x[1].y(), 1 - 3 * 0.125);
  EXPECT_EQ(run.body().u[1], Vec3(7, 7, 7));  // not held by force
  EXPECT_EQ(run.step_count(), 1u);
}

TEST(Reference, VerletStepByHand) {
  const Rule rule = two_types();
  Reference run(rule, two(2), {}, velocity_verlet);
  run.step();
  // Relative motion along x: a = 2 * 0.5 * (3 - r)/2 per unit mass, w = -0.75 at r = 2.
  const double half = -0.75 + 0.5 * 1 * 0.125 / 2, r = 2 + half * 0.125;
  // y separates too, by 1 * 0.125.
  const double distance = std::hypot(r, 0.125);
  const double w = half + 0.5 * (3 - distance) * r / distance * 0.125 / 2;
  EXPECT_NEAR(run.body().x[1].x() - run.body().x[0].x(), r, 1e-15);
  EXPECT_NEAR(run.body().v[1].x() - run.body().v[0].x(), w, 1e-15);
}

// A particle alone under a PD controller, moving anchor: u'' + (kd/m) u' + (kp/m) u = 0 exactly at the
// anchor's speed.
TEST(Reference, ControllerIsADampedOscillatorAroundItsMovingAnchor) {
  for (const Integrator integrator : {semi_implicit_euler, velocity_verlet}) {
    Rule rule = test::simple_rule(line(), 2.0, 1e-4);
    rule.types[0].pd = true;
    rule.types[0].velocity = Vec3(0.3, 0, 0);
    rule.types[0].kp = 8;
    rule.types[0].kd = 0.8;
    Body body;
    body.x = {Vec3(0, 0, 0)};
    body.v = {Vec3(0.3, 0, 0)};
    body.u = {Vec3(0.1, 0, 0)};
    body.type = {0};
    Reference run(rule, body, {}, integrator);
    run.step(10000);
    const double t = 1, gamma = 0.2, omega = std::sqrt(4 - gamma * gamma);
    const double u = 0.1 * std::exp(-gamma * t) * (std::cos(omega * t) + gamma / omega * std::sin(omega * t));
    EXPECT_NEAR(run.body().u[0].x(), u, 3e-5);
    EXPECT_NEAR(run.body().x[0].x(), 0.3 * t + u - 0.1, 3e-5);
  }
}

struct ShakenCrystal {
  Body body;
  Periodic box;
  double pitch;
};
ShakenCrystal shaken(const PairLaw& law, int cells, double shift, double speed) {
  ShakenCrystal c;
  c.pitch = relaxed_pitch(law, 1.1);
  c.body = test::fcc_block(cells, c.pitch);
  c.box = test::fcc_box(cells, c.pitch);
  test::shake(c.body, shift, speed, 7);
  return c;
}

TEST(Reference, ForcesAreTheGradientOfTheEnergy) {
  const auto law = lennard_jones(1, 1, 2.3, 0.8);
  ShakenCrystal c = shaken(*law, 3, 0.05, 0);
  for (const Periodic& periodic : {Periodic{}, c.box}) {
    const Rule rule = test::simple_rule(law, 1, 0.001);
    const std::vector<Vec3> f = Reference(rule, c.body, periodic, semi_implicit_euler).forces();
    for (const size_t i : {0u, 17u, 53u, 107u}) {
      for (int axis = 0; axis < 3; ++axis) {
        const double h = 1e-5;
        Body plus = c.body, minus = c.body;
        plus.x[i][axis] += h;
        minus.x[i][axis] -= h;
        const double gradient = (Reference(rule, plus, periodic, semi_implicit_euler).potential_energy() -
                                 Reference(rule, minus, periodic, semi_implicit_euler).potential_energy()) /
                                (2 * h);
        EXPECT_NEAR(f[i][axis], -gradient, 1e-6 * std::max(1.0, std::abs(gradient))) << i << ' ' << axis;
      }
    }
  }
}

// The mean virial stress of a periodic box is the derivative of its energy by strain over its volume.
TEST(Reference, StressIsTheDerivativeOfTheEnergyByStrain) {
  const auto law = lennard_jones(1, 1, 2.3, 0.8);
  const ShakenCrystal c = shaken(*law, 4, 0.05, 0);
  const Rule rule = test::simple_rule(law, 1, 0.001);
  const double volume = c.box.extent.prod();
  const double n = static_cast<double>(c.body.size());
  Mat3 mean = Mat3::Zero();
  for (const Mat3& s : Reference(rule, c.body, c.box, semi_implicit_euler).virial_stress(volume / n))
    mean += s / n;
  for (int axis = 0; axis < 3; ++axis) {
    const auto energy = [&](double strain) {
      Body body = c.body;
      Periodic box = c.box;
      for (Vec3& x : body.x) x[axis] *= 1 + strain;
      box.extent[axis] *= 1 + strain;
      return Reference(rule, body, box, semi_implicit_euler).potential_energy();
    };
    EXPECT_NEAR(mean(axis, axis), (energy(1e-6) - energy(-1e-6)) / (2e-6 * volume),
                1e-5 * std::abs(mean(axis, axis)));
    EXPECT_GT(std::abs(mean(axis, axis)), 0.1);
  }
}

// The invariants of the rule: translation, permutation, momentum, angular momentum, reversal.
TEST(Reference, KeepsWhatTheRuleKeeps) {
  const auto law = lennard_jones(1, 1, 2.3, 0.8);
  const ShakenCrystal c = shaken(*law, 3, 0.05, 0.3);
  Rule rule = test::simple_rule(law, 1, 0.002);
  rule.damping.coefficient = 0.5;
  const auto angular = [](const Body& body) {
    Vec3 sum = Vec3::Zero();
    for (size_t i = 0; i < body.size(); ++i) sum += body.x[i].cross(body.v[i]);
    return sum;
  };
  for (const Integrator integrator : {semi_implicit_euler, velocity_verlet}) {
    Reference run(rule, c.body, {}, integrator);
    run.step(50);
    EXPECT_LT(run.momentum().norm(), 1e-12);
    EXPECT_LT((angular(run.body()) - angular(c.body)).norm(), 1e-11);

    Body moved = c.body;
    const Vec3 by(3.25, -17.5, 0.125);
    for (Vec3& x : moved.x) x += by;
    std::swap(moved.x[3], moved.x[90]);
    std::swap(moved.v[3], moved.v[90]);
    Reference other(rule, moved, {}, integrator);
    other.step(50);
    Body back = other.body();
    std::swap(back.x[3], back.x[90]);
    for (size_t i = 0; i < back.size(); ++i) EXPECT_LT((back.x[i] - by - run.body().x[i]).norm(), 1e-11) << i;
  }
  rule.damping.coefficient = 0;
  Reference run(rule, c.body, c.box, velocity_verlet);
  run.step(50);
  Body turned = run.body();
  for (Vec3& v : turned.v) v = -v;
  Reference back(rule, turned, c.box, velocity_verlet);
  back.step(50);
  for (size_t i = 0; i < turned.size(); ++i) EXPECT_LT((back.body().x[i] - c.body.x[i]).norm(), 1e-11) << i;
}

// Semi-implicit Euler and velocity Verlet are one method up to where the velocity is taken: started half a
// step apart they hold the same positions.
TEST(Reference, EulerIsVerletWithVelocitiesAtHalfSteps) {
  const auto law = lennard_jones(1, 1, 2.3, 0.8);
  const ShakenCrystal c = shaken(*law, 3, 0.05, 0.3);
  const Rule rule = test::simple_rule(law, 1, 0.002);
  Reference verlet(rule, c.body, {}, velocity_verlet);
  Body behind = c.body;
  const std::vector<Vec3> f = verlet.forces();
  for (size_t i = 0; i < behind.size(); ++i) behind.v[i] -= f[i] / rule.mass * rule.dt / 2;
  Reference euler(rule, behind, {}, semi_implicit_euler);
  verlet.step(100);
  euler.step(100);
  for (size_t i = 0; i < behind.size(); ++i) {
    EXPECT_LT((verlet.body().x[i] - euler.body().x[i]).norm(), 1e-11) << i;
  }
}

// dt = 2/omega_max is the limit: just below it a shaken packing stays, just above it flies apart.
TEST(Reference, LeapfrogIsStableUpToTheLargestFrequency) {
  const double pitch = 1e-4, k = 3e4, mass = 1e-9;
  const auto law = preset_law("elastic", pitch, k);
  const double limit = 2 / largest_frequency(*law, mass, pitch);
  const auto energy_after = [&](double dt) {
    Body body = test::fcc_block(4, pitch);
    test::shake(body, 1e-9 * pitch, 0, 3);
    Reference run(test::simple_rule(law, mass, dt), body, test::fcc_box(4, pitch), semi_implicit_euler);
    run.step(400);
    return run.kinetic_energy() / (k * pitch * pitch * 1e-18);
  };
  EXPECT_LT(energy_after(0.99 * limit), 1e4);
  EXPECT_GT(energy_after(1.01 * limit), 1e12);
}

// Damping by the velocity of the half step before lowers the limit. A mode of frequency w and damping rate g
// steps by z^2 - (2 - w^2 dt^2 - g dt) z + 1 - g dt = 0; |z| <= 1 down to z = -1, where w^2 dt^2 + 2 g dt
// = 4. Nearest neighbours alone are damped as they are bound, so g = (c/k) w^2 in every mode, with c =
// c(pitch) = coefficient/4.
TEST(Reference, DampingLowersTheLimit) {
  const auto law = preset_law("elastic", 1, 1);
  Rule rule = test::simple_rule(law, 1, 0);
  rule.damping.coefficient = 1;
  const double w2 = 8, g = 8 * rule.damping.coefficient / 4;
  const double limit = (-g + std::sqrt(g * g + 4 * w2)) / w2;
  EXPECT_LT(limit, 0.8 * 2 / largest_frequency(*law, 1, 1));
  const auto energy_after = [&](double dt) {
    Body body = test::fcc_block(4, 1);
    test::shake(body, 1e-9, 0, 3);
    rule.dt = dt;
    Reference run(rule, body, test::fcc_box(4, 1), semi_implicit_euler);
    run.step(400);
    return run.kinetic_energy() / 1e-18;
  };
  EXPECT_LT(energy_after(0.99 * limit), 1e2);
  EXPECT_GT(energy_after(1.01 * limit), 1e6);
}

// NVE: the energy of velocity Verlet fluctuates as dt^2, that of semi-implicit Euler's half-step velocities
// as dt. The cutoff lies midway between two shells and the crystal is cold, so that no pair crosses it and
// the energy is smooth.
TEST(Reference, EnergyFluctuatesAsTheOrderOfTheIntegrator) {
  const auto law = lennard_jones(1, 1, 2.567, 0.8);
  const ShakenCrystal c = shaken(*law, 4, 0, 0.35);
  const auto rms = [&](Integrator integrator, double dt) {
    Reference run(test::simple_rule(law, 1, dt), c.body, c.box, integrator);
    const int steps = static_cast<int>(std::lround(2 / dt));
    std::vector<double> energy;
    for (int n = 0; n < steps; ++n) {
      run.step();
      energy.push_back(run.kinetic_energy() + run.potential_energy());
    }
    double mean = 0, square = 0;
    for (const double e : energy) mean += e / steps;
    for (const double e : energy) square += (e - mean) * (e - mean) / steps;
    return std::sqrt(square) / static_cast<double>(c.body.size());
  };
  const double fine = rms(velocity_verlet, 0.0025), middle = rms(velocity_verlet, 0.005),
               coarse = rms(velocity_verlet, 0.01);
  EXPECT_NEAR(middle / fine, 4, 0.2);
  EXPECT_NEAR(coarse / middle, 4, 0.2);
  EXPECT_GT(fine, 1e-9);  // above rounding
  EXPECT_NEAR(rms(semi_implicit_euler, 0.005) / rms(semi_implicit_euler, 0.0025), 2, 0.2);
}

TEST(Reference, DampingTakesEnergyAndLeavesMotionOfTheWhole) {
  const auto law = preset_law("viscous", 1, 1);
  Body body = test::fcc_block(3, 1);
  test::shake(body, 0.01, 0.01, 5);
  for (Vec3& v : body.v) v += Vec3(0.5, 0.25, 0);
  Rule rule = test::simple_rule(law, 1, 0.05);
  rule.damping.coefficient = 0.5;
  Reference run(rule, body, test::fcc_box(3, 1), semi_implicit_euler);
  run.step(2000);
  for (const Vec3& v : run.body().v) EXPECT_LT((v - Vec3(0.5, 0.25, 0)).norm(), 1e-4);
}

TEST(Reference, RefusesWhatDoesNotFit) {
  const auto text_of = [](const Body& body) -> std::string {
    return refused_with([&] { Reference(two_types(), body, {}, semi_implicit_euler); });
  };
  Body body = two(2);
  EXPECT_EQ(text_of(body), "accepted");
  body.type[1] = 2;
  EXPECT_EQ(text_of(body), "particle 1 has type 2, but the rule has 2");
  body.v.pop_back();
  EXPECT_EQ(text_of(body), "a body of 2 positions has 1 velocities, 2 types and 0 displacements");
}

TEST(Reference, StopsWhereAPositionIsLost) {
  Body body = two(2);
  body.v[1].x() = 1e308;
  Rule rule = two_types();
  rule.dt = 100;
  Reference run(rule, body, {}, semi_implicit_euler);
  EXPECT_EQ(refused_with<std::runtime_error>([&] { run.step(5); }),
            "step 0: particle 1 has no finite position; is dt too long?");
}

}  // namespace
}  // namespace cuboct
