// SPDX-License-Identifier: MIT
#include "model/analysis/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "model/scene/scene.h"

namespace cuboct {
namespace {

// A spring of stiffness k and rest length 0 up to the cutoff: f(r) = -k r, so that f/r is the one constant of
// the table and every number below can be had by hand.
class Spring : public PairLaw {
 public:
  Spring(double stiffness, double cutoff) : stiffness_(stiffness), cutoff_(cutoff) {}
  double force(double r) const override { return r < cutoff_ ? -stiffness_ * r : 0; }
  double energy(double r) const override {
    return r < cutoff_ ? 0.5 * stiffness_ * (r * r - cutoff_ * cutoff_) : 0;
  }
  double slope(double r) const override { return r < cutoff_ ? -stiffness_ : 0; }
  double cutoff() const override { return cutoff_; }
  double core() const override { return 1e-6; }

 private:
  double stiffness_, cutoff_;
};

// Two particles, half a cell apart across a face; cell edge 2 m, dt 0.5 s, mass 3 kg.
//   f/r * dt^2/m = -1/16  =>  k = m/(16 dt^2) = 0.75 N/m; d = 0.5 cell = 1 m, so each is pulled with 0.75 N,
//   and the kick is 0.5 cell/16 = 1/32 cell per step.
struct TwoParticles {
  Rule rule;
  FixedRule fixed;
  Lattice lattice{{{0, 0, 0}, {1, 0, 0}}, {0, 0, 0}};
  Vec3 origin{10, 20, 30};
  State state;

  TwoParticles() {
    rule.law = std::make_shared<Spring>(0.75, 1.9);
    rule.mass = 3;
    rule.dt = 0.5;
    rule.types.resize(1);
    rule.strength = {{1.0}};

    fixed.cell_edge = 2;
    fixed.dt = 0.5;
    fixed.mass = 3;
    const Widths& w = fixed.widths;
    fixed.cutoff2 = static_cast<uint64_t>(0.95 * 0.95 * std::ldexp(1.0, 2 * w.difference_frac));
    set_planar(fixed);
    fixed.force.value_frac = 16;  // E
    fixed.force.c0.assign(512, -(1 << 12));
    fixed.force.c1.assign(512, 0);
    fixed.difference_shift = w.position_frac - w.difference_frac;
    fixed.kick_shift = fixed.force.value_frac + w.difference_frac - w.velocity_frac();
    fixed.types.resize(1);

    const int64_t edge = int64_t{1} << w.velocity_frac();
    state.particles.push_back({0, 0, 0, {edge * 3 / 4, edge / 2, edge / 4}, {}, {}});
    state.particles.push_back({1, 0, 1, {edge / 4, edge / 2, edge / 4}, {}, {}});
  }
  int64_t velocity(double cells_per_step) const {
    return static_cast<int64_t>(std::ldexp(cells_per_step, fixed.widths.velocity_frac()));
  }
};

TEST(Measure, ForceOfTwoParticlesByHand) {
  const TwoParticles two;
  const auto kicks = summed_kicks(two.fixed, two.lattice, two.state);
  EXPECT_EQ(kicks[0], (Int3{two.velocity(1.0 / 32), 0, 0}));
  EXPECT_EQ(kicks[1], (Int3{-two.velocity(1.0 / 32), 0, 0}));
  const Sample sample = sample_of(two.fixed, two.lattice, two.origin, two.state, kicks);
  EXPECT_DOUBLE_EQ(sample.force[0].x(), 0.75);
  EXPECT_DOUBLE_EQ(sample.force[1].x(), -0.75);
  EXPECT_EQ(sample.x[0], Vec3(11.5, 21, 30.5));
  EXPECT_EQ(sample.x[1], Vec3(12.5, 21, 30.5));
}

TEST(Measure, EnergiesOfTwoParticlesByHand) {
  TwoParticles two;
  two.rule.types[0].gravity = Vec3(0, 0, -10);
  // v + dv/2 of particle 0 is 3/32 + 1/64 = 7/64 cell per step = 7/16 m/s along x; of particle 1, -1/64 =
  // -1/16 m/s.
  two.state.particles[0].v = {two.velocity(3.0 / 32), 0, 0};
  const auto kicks = summed_kicks(two.fixed, two.lattice, two.state);
  const Energies e = energies(two.rule, two.fixed, two.lattice, two.origin, two.state, kicks);
  EXPECT_DOUBLE_EQ(e.kinetic, 0.5 * 3 * (49.0 / 256 + 1.0 / 256));
  EXPECT_DOUBLE_EQ(e.potential, 0.5 * 0.75 * (1 - 1.9 * 1.9));
  EXPECT_DOUBLE_EQ(e.gravity, 2 * 3 * 10 * 30.5);
  EXPECT_DOUBLE_EQ(e.total(), e.kinetic + e.potential + e.gravity);
}

// Each is pulled with 0.75 N over 1 m: in 8 m^3 a tension of 0.75/8 Pa along x. The kinetic energy is as
// above.
TEST(Measure, VirialAndPressureOfTwoParticlesByHand) {
  TwoParticles two;
  const Mat3 stress = virial_stress(two.fixed, two.lattice, two.state, 8);
  EXPECT_DOUBLE_EQ(stress(0, 0), 0.75 / 8);
  EXPECT_EQ(stress.cwiseAbs().sum(), stress(0, 0));
  two.state.particles[0].v = {two.velocity(3.0 / 32), 0, 0};
  const auto kicks = summed_kicks(two.fixed, two.lattice, two.state);
  const Energies e = energies(two.rule, two.fixed, two.lattice, two.origin, two.state, kicks);
  EXPECT_DOUBLE_EQ(pressure(e, stress, 8), (2.0 / 3 * e.kinetic - 0.75 / 3) / 8);
}

// A controller's part of the step counts as well. Particle 0: v = 3/32, u = 3/16 cell; with kp = 1/8 and kd =
// 1/4 the step adds 1/32 - 3/128 - 3/128 = -1/64, so that at the time of the positions v is 11/128 cell per
// step = 11/32 m/s. Particle 1: v = u = 0, the step adds -1/32: -1/16 m/s.
TEST(Measure, AParticleHeldByForceFeelsItsController) {
  TwoParticles two;
  FixedType& type = two.fixed.types[0];
  type.pd = two.fixed.pd = two.rule.types[0].pd = true;
  type.kp = int64_t{1} << (two.fixed.widths.gain_frac - 3);
  type.kd = int64_t{1} << (two.fixed.widths.gain_frac - 2);
  Particle& held = two.state.particles[0];
  held.v = {two.velocity(3.0 / 32), 0, 0};
  held.u = {two.velocity(3.0 / 16), 0, 0};
  const auto kicks = summed_kicks(two.fixed, two.lattice, two.state);
  EXPECT_EQ(finish(two.fixed, kicks[0], held.x, held.v, held.u, 0).v[0], two.velocity(3.0 / 32 - 1.0 / 64));
  EXPECT_DOUBLE_EQ(energies(two.rule, two.fixed, two.lattice, two.origin, two.state, kicks).kinetic,
                   0.5 * 3 * (121.0 / 1024 + 1.0 / 256));
}

TEST(Measure, AHeldParticleGainsNoKineticEnergy) {
  TwoParticles two;
  two.fixed.types[0].imposed = {true, true, true};
  const auto kicks = summed_kicks(two.fixed, two.lattice, two.state);
  EXPECT_EQ(energies(two.rule, two.fixed, two.lattice, two.origin, two.state, kicks).kinetic, 0);
}

TEST(Measure, LargestSpeedIsAFractionOfANode) {
  TwoParticles two;
  EXPECT_EQ(largest_speed(two.fixed, two.state), 0);
  two.state.particles[1].v = {two.velocity(0.125), -two.velocity(0.25), 0};
  EXPECT_EQ(largest_speed(two.fixed, two.state), 0.25);
}

TEST(Measure, KnowsWhichRulesConserveWhat) {
  TwoParticles two;
  EXPECT_TRUE(keeps_energy(two.rule, {}));
  EXPECT_TRUE(keeps_momentum(two.rule));
  const auto with = [&](auto change) {
    Rule rule = two.rule;
    change(rule);
    return std::pair(keeps_energy(rule, {}), keeps_momentum(rule));
  };
  EXPECT_EQ(with([](Rule& r) { r.damping.coefficient = 1; }), std::pair(false, true));
  EXPECT_EQ(with([](Rule& r) { r.types[0].imposed[1] = true; }), std::pair(true, false));
  EXPECT_EQ(with([](Rule& r) { r.types[0].imposed[1] = true, r.types[0].velocity[1] = 1; }),
            std::pair(false, false));
  EXPECT_EQ(with([](Rule& r) { r.types[0].gravity[2] = -9.81; }), std::pair(true, false));
  EXPECT_EQ(with([](Rule& r) { r.types[0].pd = true; }), std::pair(false, false));
  Rule falling = two.rule;
  falling.types[0].gravity[2] = -9.81;
  EXPECT_FALSE(keeps_energy(falling, {Vec3::Zero(), Vec3(0, 0, 1)}));
}

// A rule of text keeps its energy unless velocities, noise or what goes on by a law of its own make forces.
TEST(Measure, KnowsWhichTextsConserveEnergy) {
  const auto keeps = [](const std::string& round, const std::string& fields = "") {
    const Scene scene = parse_scene(
        "units = \"reduced\"\nmass = 1\npacking = { pitch = 1 }\nbox = { cells = [2, 2, 2] }\n"
        "run = { dt = 0.01, steps = 1 }\n[rule]\nreach = \"1.2\"\n" +
            fields + round,
        "s.toml");
    return keeps_energy(scene.rule, {});
  };
  const std::string spring = "[[rule.round]]\nsum.force = \"(r - 1) * d / r";
  EXPECT_TRUE(keeps(spring + "\"\n"));
  EXPECT_FALSE(keeps(spring + " + v_j - v_i\"\n"));
  EXPECT_FALSE(keeps(spring + " + noises(1)\"\n"));
  // What velocities make is felt through a field of an earlier round, and not where only frames show it.
  const std::string fast = "particle.fast = {}\n";
  const std::string first = "[[rule.round]]\nfinish.fast = \"dot(v, v)\"\n";
  EXPECT_FALSE(keeps(first + spring + " * (1 + fast_i)\"\n", fast));
  EXPECT_TRUE(keeps(first + spring + "\"\n", fast));
  // Springs that soften as a field goes on.
  const std::string age = "particle.age = {}\n", ages = "finish.age = \"age + dt\"\n";
  EXPECT_FALSE(keeps(spring + " / (1 + age_i + age_j)\"\n" + ages, age));
  EXPECT_TRUE(keeps(spring + "\"\n" + ages, age));
}

Probe probe_of(Probe::Kind kind, const std::string& name) {
  Probe probe;
  probe.kind = kind;
  probe.name = name;
  return probe;
}

TEST(Probes, FollowTheirDefinitions) {
  Probe force = probe_of(Probe::Kind::force, "f");
  force.set.ids = {0, 1};
  Probe moved = probe_of(Probe::Kind::displacement, "d");
  moved.set.ids = {1, 2};
  Probe pull = probe_of(Probe::Kind::stress_strain, "pull");
  pull.lower.ids = {0};
  pull.upper.ids = {1, 2};
  pull.grip.ids = {2};
  pull.axis = Vec3::UnitZ();
  pull.area = 0.5;

  const std::vector<Vec3> initial{{0, 0, 0}, {0, 0, 4}, {0, 0, 6}};
  ProbeMeter meter({force, moved, pull}, {}, initial);
  meter.add({0, initial, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, {}});
  meter.add({10, {{0, 0, -1}, {1, 0, 4}, {2, 0, 7}}, {{1, 2, 3}, {10, 20, 30}, {0, 0, -8}}, {}});

  std::vector<std::string> names;
  std::vector<double> last;
  for (const Curve& curve : meter.curves()) {
    EXPECT_EQ(curve.step, (std::vector<uint64_t>{0, 10}));
    EXPECT_EQ(curve.value[0], 0);
    names.push_back(curve.name + " " + curve.unit);
    last.push_back(curve.value[1]);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"f.force_x N", "f.force_y N", "f.force_z N", "d.x m", "d.y m",
                                             "d.z m", "pull.strain 1", "pull.stress Pa"}));
  // Gauge 5 m; the marks moved by -1 and +0.5: strain 0.3. The body pulls the grip down with 8 N over 0.5
  // m^2.
  EXPECT_EQ(last, (std::vector<double>{11, 22, 33, 1.5, 0, 0.5, 0.3, 16}));
}

// One component instead of three; a pull along (0, 0.6, 0.8).
TEST(Probes, FollowAnAxis) {
  Probe force = probe_of(Probe::Kind::force, "f"), moved = probe_of(Probe::Kind::displacement, "d"),
        pull = probe_of(Probe::Kind::stress_strain, "pull");
  force.set.ids = moved.set.ids = pull.upper.ids = pull.grip.ids = {1};
  pull.lower.ids = {0};
  pull.area = 2;
  for (Probe* probe : {&force, &moved, &pull}) probe->axis = Vec3(0, 0.6, 0.8);
  ProbeMeter meter({force, moved, pull}, {}, {{0, 0, 0}, {0, 0, 5}});
  meter.add({1, {{0, 0, 0}, {7, 5, 5}}, {Vec3::Zero(), {9, 10, 20}}, {}});
  std::vector<std::string> names;
  for (const Curve& curve : meter.curves()) names.push_back(curve.name);
  EXPECT_EQ(names, (std::vector<std::string>{"f.force", "d.along", "pull.strain", "pull.stress"}));
  const double expected[] = {22, 3, 3.0 / 4, -11};
  for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(meter.curves()[k].value[0], expected[k], 1e-12) << names[k];
}

TEST(Probes, CountRoundsOfAPeriodicBox) {
  Probe moved = probe_of(Probe::Kind::displacement, "d");
  moved.set.ids = {0};
  ProbeMeter meter({moved}, {Vec3::Zero(), Vec3(1, 0, 0)}, {Vec3(0.1, 0, 0)});
  for (uint64_t step = 0; step <= 10; ++step)
    meter.add(
        {step, {Vec3(std::fmod(0.1 + 0.4 * static_cast<double>(step), 1.0), 0, 0)}, {Vec3::Zero()}, {}});
  EXPECT_NEAR(meter.curves()[0].value.back(), 4.0, 1e-12);
}

}  // namespace
}  // namespace cuboct
