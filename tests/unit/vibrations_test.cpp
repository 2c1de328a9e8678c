// SPDX-License-Identifier: MIT
// The matrices of small vibrations against finite differences of the engine's forces, closed forms and
// lattice sums; the stability limit against the spectral radius of one step of the engine.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "model/contract/law.h"
#include "model/real/reference.h"
#include "model/solid/dynamical_matrix.h"
#include "model/solid/stiffest_parts.h"
#include "model/solid/vibrations.h"
#include "tests/fcc_block.h"

namespace cuboct {
namespace {

Vibrations vibrations(const Rule& rule, const Body& body, const Periodic& box = {}) {
  return vibrations_of(rule, body, box);
}

// x[n+1], v[n+1] of one step of semi-implicit Euler, as a matrix: the update map of the header.
double spectral_radius(const Vibrations& vibrations, double dt) {
  const Eigen::MatrixXd k = vibrations.stiffness;
  const auto n = k.rows();
  const Eigen::MatrixXd c =
      vibrations.damping.rows() > 0 ? Eigen::MatrixXd(vibrations.damping) : Eigen::MatrixXd::Zero(n, n);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd map(2 * n, 2 * n);  // of (x, v dt)
  map << one - dt * dt * k, one - dt * c, -dt * dt * k, one - dt * c;
  return Eigen::EigenSolver<Eigen::MatrixXd>(map, false).eigenvalues().cwiseAbs().maxCoeff();
}

// A small bent cluster: all bonds of different lengths, some pushed, some pulled; two materials; one particle
// held along z, one held by force.
struct Cluster {
  Rule rule;
  Body body;

  Cluster(uint64_t seed, double damping, double kp, double kd) {
    body = test::fcc_block(1, 1);
    test::shake(body, 0.03, 0, seed);
    rule = test::simple_rule(preset_law("elastic", 1, 3), 2, 0.01);
    rule.damping.coefficient = damping;
    rule.types.resize(4);
    rule.types[1].imposed = {false, false, true};
    rule.types[2].material = 1;
    rule.types[3].pd = kp > 0;
    rule.types[3].kp = kp, rule.types[3].kd = kd;
    rule.strength = {{1, 0.7}, {0.7, 2.5}};
    for (size_t i = 0; i < body.size(); ++i) body.type[i] = static_cast<uint8_t>(i % 4);
  }
};

TEST(Vibrations, AreTheDerivativesOfTheEnginesForces) {
  const Cluster c(5, 0.4, 1.5, 0.3);
  const Vibrations out = vibrations(c.rule, c.body);
  ASSERT_EQ(out.particle.size(), 3 * c.body.size() - c.body.size() / 4);
  // By one step of the engine from a body with one position, or one velocity, shifted: v' - v = a dt.
  const double h = 1e-5;
  const auto kick = [&](size_t dof, double shift, bool of_velocity) {
    Body body = c.body;
    body.u.assign(body.size(), Vec3::Zero());
    (of_velocity ? body.v : body.x)[out.particle[dof]][out.axis[dof]] += shift;
    if (!of_velocity) body.u[out.particle[dof]][out.axis[dof]] += shift;
    const std::vector<Vec3> before = body.v;
    Reference run(c.rule, body, {}, Integrator::semi_implicit_euler);
    run.step();
    Eigen::VectorXd a(out.particle.size());
    for (size_t i = 0; i < out.particle.size(); ++i)
      a[i] = (run.body().v[out.particle[i]] - before[out.particle[i]])[out.axis[i]] / c.rule.dt;
    return a;
  };
  const Eigen::MatrixXd k = out.stiffness, g = out.damping;
  for (size_t dof = 0; dof < out.particle.size(); ++dof) {
    // Central differences err by the law's third derivative, about 100 h^2, and rounding, 1e-15/h.
    const Eigen::VectorXd dk = -(kick(dof, h, false) - kick(dof, -h, false)) / (2 * h);
    EXPECT_LT((dk - k.col(dof)).cwiseAbs().maxCoeff(), 1e-7) << "degree of freedom " << dof;
    const Eigen::VectorXd dc = -(kick(dof, h, true) - kick(dof, -h, true)) / (2 * h);
    EXPECT_LT((dc - g.col(dof)).cwiseAbs().maxCoeff(), 1e-7) << "degree of freedom " << dof;
  }
}

// The limit from the eigenvalues is where the spectral radius of the map passes 1.
TEST(Vibrations, TheLimitIsThatOfTheUpdateMap) {
  int damped_most = 0, cases = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    const double damping = seed % 3 == 0 ? 0 : 0.3 * static_cast<double>(seed * seed % 50);
    const double kp = seed % 2 == 0 ? 0 : 0.5 * static_cast<double>(seed % 7);
    const Cluster c(seed, damping, kp, 0.2 * static_cast<double>(seed % 5));
    const Vibrations out = vibrations(c.rule, c.body);
    // Negative eigenvalues (a shaken cluster may have some) grow at any dt: they are lifted to test the rest.
    Vibrations lifted = out;
    const Limit raw = stability_limit(out);
    if (raw.softest < 0)
      for (Eigen::Index i = 0; i < lifted.stiffness.rows(); ++i)
        lifted.stiffness.coeffRef(i, i) += -raw.softest * 1.001 + 1e-3;
    const Limit limit = stability_limit(lifted);
    ASSERT_FALSE(limit.body_unstable());
    EXPECT_LE(spectral_radius(lifted, 0.999 * limit.dt), 1 + 1e-9) << "seed " << seed;
    EXPECT_GT(spectral_radius(lifted, 1.001 * limit.dt), 1 + 1e-4) << "seed " << seed;
    damped_most += limit.damping_share > 0.5;
    ++cases;
  }
  EXPECT_EQ(cases, 30);
  EXPECT_GE(damped_most, 5);  // the random cases hold both kinds
  EXPECT_LE(damped_most, 25);
}

TEST(Vibrations, APeriodicBlockIsThePerfectPacking) {
  // 4 cells hold the wave vectors X and L, where the presets have their largest frequency.
  const Rule rule = test::simple_rule(preset_law("ductile", 1, 5), 3, 0.01);
  const Limit limit = stability_limit(vibrations(rule, test::fcc_block(4, 1), test::fcc_box(4, 1)));
  EXPECT_NEAR(limit.frequency, largest_frequency(*rule.law, rule.mass, 1), 1e-6 * limit.frequency);
  EXPECT_NEAR(limit.dt, 2 / limit.frequency, 1e-12 * limit.dt);
  EXPECT_FALSE(limit.body_unstable());

  const Rule lj = test::simple_rule(lennard_jones(1, 1, 1.8, 0.8), 1, 0.004);
  const double pitch = relaxed_pitch(*lj.law, 1.1);
  const Limit of_lj = stability_limit(vibrations(lj, test::fcc_block(4, pitch), test::fcc_box(4, pitch)));
  EXPECT_NEAR(of_lj.frequency, largest_frequency(*lj.law, 1, pitch), 2e-4 * of_lj.frequency);
}

// Two particles and a spring: w^2 = 2k/m, damping rate 2c/m; dt^2 2k/m + 2 dt 2c/m = 4.
TEST(Vibrations, ADimer) {
  Rule rule = test::simple_rule(preset_law("elastic", 1, 3), 2, 0.01);
  Body body;
  body.x = {Vec3(0, 0, 0), Vec3(0, 0.6, 0.8)};
  body.v.assign(2, Vec3::Zero());
  body.type.assign(2, 0);
  const Limit free = stability_limit(vibrations(rule, body));
  EXPECT_NEAR(free.frequency, std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(free.dt, 2 / std::sqrt(3.0), 1e-12);
  rule.damping.coefficient = 8;  // c(1) = 8/4: the cutoff is sqrt(2)
  const Limit damped = stability_limit(vibrations(rule, body));
  EXPECT_NEAR(damped.dt * damped.dt * 3 + 4 * damped.dt, 4, 1e-5);
  EXPECT_NEAR(damped.damping_share, damped.dt, 1e-5);

  body.x[1] = Vec3(0, 0, 5);  // out of reach
  EXPECT_TRUE(std::isinf(stability_limit(vibrations(rule, body)).dt));
}

// A chain that is pushed together buckles: its least eigenvalue says so.
TEST(Vibrations, ABodyThatBucklesIsUnstable) {
  Rule rule = test::simple_rule(preset_law("elastic", 1, 3), 2, 0.01);
  rule.types.resize(2);
  rule.types[1].imposed = {true, true, true};
  Body body;
  body.x = {Vec3(0, 0, 0), Vec3(0.9, 0, 0), Vec3(1.8, 0, 0)};
  body.v.assign(3, Vec3::Zero());
  body.type = {1, 0, 1};
  const Limit limit = stability_limit(vibrations(rule, body));
  EXPECT_TRUE(limit.body_unstable());
  const double f = rule.law->force(0.9);  // both bonds push: lateral constants -f/r each
  EXPECT_NEAR(limit.softest, -2 * f / 0.9 / rule.mass, 1e-9);
  body.x = {Vec3(0, 0, 0), Vec3(1.05, 0, 0), Vec3(2.1, 0, 0)};
  EXPECT_FALSE(stability_limit(vibrations(rule, body)).body_unstable());
}

// A crystal that shakes, in a box: parts find the limit of all to some per cent, and where one pair is
// pressed together the limit of that pair. Bounds of the rows are above the largest eigenvalue.
TEST(StiffestParts, HaveTheLimitOfTheWhole) {
  Rule rule;
  rule.law = lennard_jones(1, 1, 1.6, 0.8);
  rule.mass = 1;
  rule.types.resize(1);
  rule.strength = {{1}};
  constexpr int kCells = 7;  // 1372 particles
  const double edge = 1.55;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> shake(-0.05, 0.05);
  Body body;
  for (int k = 0; k < 4 * kCells * kCells * kCells; ++k) {
    const Vec3 cell(k / 4 % kCells, k / 4 / kCells % kCells, k / 4 / kCells / kCells);
    const Vec3 site =
        k % 4 == 0 ? Vec3(0, 0, 0) : Vec3(k % 4 == 1 ? 0 : 0.5, k % 4 == 2 ? 0 : 0.5, k % 4 == 3 ? 0 : 0.5);
    body.x.push_back(edge * (cell + site) + Vec3(shake(random), shake(random), shake(random)));
  }
  body.v.assign(body.size(), Vec3::Zero());
  body.type.assign(body.size(), 0);
  const Periodic box{Vec3::Constant(kCells * edge), Vec3::Zero()};
  for (const bool pressed : {false, true}) {
    if (pressed) body.x[900] = body.x[901] + 0.9 * (body.x[900] - body.x[901]).normalized();
    const Limit whole = stability_limit(vibrations_of(rule, body, box));
    const std::vector<double> bounds = stiffness_bounds(rule, body, box);
    const double highest = *std::max_element(bounds.begin(), bounds.end());
    EXPECT_GT(highest, whole.frequency * whole.frequency);
    EXPECT_LT(highest, 3 * whole.frequency * whole.frequency);
    const double parts = stiffest_parts_limit(rule, body, box, 200);
    EXPECT_GT(parts, whole.dt * (1 - 1e-4));
    EXPECT_LT(parts, whole.dt * (pressed ? 1.001 : 1.06));
  }
}

}  // namespace
}  // namespace cuboct
