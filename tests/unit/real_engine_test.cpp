// SPDX-License-Identifier: MIT
// The reference engine as a machine: lists, vectors, threads, precision. Its physics is in
// reference_test.cpp.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <set>

#include "model/base/error.h"
#include "model/contract/law.h"
#include "model/real/reference.h"
#include "tests/fcc_block.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using enum Precision;

// Forces by all pairs, as the rule is written: no lists, no forms of laws, no vectors.
std::vector<Vec3> plain_forces(const Rule& rule, const Body& body, const Periodic& box) {
  std::vector<Vec3> f(body.size(), Vec3::Zero());
  for (size_t i = 0; i < body.size(); ++i)
    for (size_t j = 0; j < body.size(); ++j) {
      Vec3 d = body.x[j] - body.x[i];
      for (int axis = 0; axis < 3; ++axis)
        if (box.extent[axis] > 0) d[axis] -= box.extent[axis] * std::round(d[axis] / box.extent[axis]);
      const double r = d.norm();
      if (r == 0 || r >= rule.reach(body.type[i], body.type[j])) continue;
      double k = rule.law_of(body.type[i], body.type[j]).force(r) / r;
      if (rule.damping.coefficient > 0) k -= rule.damping_over_r2(r) * (body.v[j] - body.v[i]).dot(d);
      f[i] -= k * rule.strength_of(body.type[i], body.type[j]) * d;
    }
  return f;
}
double largest(const std::vector<Vec3>& f) {
  double most = 0;
  for (const Vec3& of : f) most = std::max(most, of.norm());
  return most;
}
double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}
bool same_bits(const Body& a, const Body& b) { return a.x == b.x && a.v == b.v; }

struct Case {
  const char* name;
  std::shared_ptr<const PairLaw> law;
  bool damped, two_materials, ring;
  bool contact = false, laws = false;
};
// Every form of a law; pieces within a vector's lanes and beyond; every branch of the kernel.
std::vector<Case> cases() {
  std::vector<double> r, f;
  for (int k = 0; k <= 24; ++k) {
    r.push_back(0.5 + k / 24.0);
    f.push_back(2 * std::cos(3 * r.back()) + (k == 24 ? -2 * std::cos(4.5) : 0));
  }
  return {{"lennard_jones", lennard_jones(1, 0.9, 1.7, 0.6), false, false, true},
          {"shifted", lennard_jones(1, 0.9, 1.5, 0.6, Smoothing::linear), false, false, true},
          {"presets", preset_law("ductile", 1, 20), true, false, false},
          {"many_pieces", spline_law(r, f, Interpolation::monotone_cubic, 0.6), false, true, true},
          {"arcs", spline_law({0.5, 0.8, 1.0, 1.3, 1.6}, {9, 4, 0, -2, 0}, Interpolation::b_spline, 0.6),
           true, true, true},
          {"contact", preset_law("brittle", 1, 20), true, true, true, true},
          {"several", preset_law("brittle", 1, 20), false, true, true, false, true},
          {"several_damped", preset_law("brittle", 1, 20), true, true, true, true, true},
          {"many_arcs", spline_law(r, f, Interpolation::b_spline, 0.6), false, false, false},
          {"asked", std::make_shared<test::BondLaw>(20, 1.6), true, false, true}};
}
struct Made {
  Rule rule;
  Body body;
  Periodic box;
};
Made made(const Case& c, double speed) {
  Made m{test::simple_rule(c.law, 1, 0.01), test::fcc_block(4, 1), {}};
  if (c.ring) m.box = test::fcc_box(4, 1);
  if (c.ring && c.damped) m.box.extent[1] = 0;
  test::shake(m.body, 0.08, speed, 5);
  if (c.damped) m.rule.damping.coefficient = 0.4;
  if (c.two_materials) {
    m.rule.types.push_back({.name = "other", .material = 1});
    m.rule.strength = {{1, 0.5}, {0.5, 1.5}};
    if (c.contact) m.rule.contact = {{0, 1}, {1, 0}}, m.rule.contact_distance = push_end(*c.law);
    for (size_t i = 0; i < m.body.size(); i += 3) m.body.type[i] = 1;
    if (c.laws) {  // of every form, most shorter than the first
      m.rule.types.push_back({.name = "third", .material = 2});
      m.rule.strength = {{1, 0.5, 2}, {0.5, 1.5, 1}, {2, 1, 0.7}};
      m.rule.other_laws = {
          lennard_jones(1, 0.9, 1.3, 0.6),
          spline_law({0.5, 0.8, 1.0, 1.2, 1.4}, {9, 4, 0, -2, 0}, Interpolation::b_spline, 0.55),
          std::make_shared<test::BondLaw>(20, 1.35)};
      m.rule.law_index = {{0, 1, 2}, {1, 3, 0}, {2, 0, 1}};
      if (c.contact) m.rule.contact = {{0, 1, 0}, {1, 0, 0}, {0, 0, 0}};
      for (size_t i = 1; i < m.body.size(); i += 3) m.body.type[i] = 2;
    }
  }
  return m;
}

// In doubles only the order of operations differs: some units of 2^-53 of the largest pair force. A core and
// a joint between pieces are met among the pairs.
TEST(RealEngine, ForcesAreThoseOfAllPairs) {
  for (const Case& c : cases()) {
    Made m = made(c, 0.5);
    m.body.x[7] = m.body.x[3] + Vec3(0.3, 0.1, 0);  // inside the core
    m.body.x[9] = m.body.x[8];                      // no direction
    const std::vector<Vec3> plain = plain_forces(m.rule, m.body, m.box);
    const Reference in_doubles(m.rule, m.body, m.box);
    EXPECT_LT(difference(in_doubles.forces(), plain), 1e-13 * largest(plain)) << c.name;
    EXPECT_GT(largest(plain), 1) << c.name;
    // 2^-24 in coordinates up to 5.6 pitches, times the law's slope.
    const Reference in_floats(m.rule, m.body, m.box, {.precision = float32});
    const double error = difference(in_floats.forces(), plain);
    EXPECT_LT(error, 3e-5 * largest(plain)) << c.name;
    EXPECT_GT(error, 1e-8 * largest(plain)) << c.name;
  }
}

// Fast particles change places: lists that came too late, or lost a pair, would leave the plain run at once.
TEST(RealEngine, ListsAreNeverLate) {
  for (const Case& c : cases()) {
    const Made m = made(c, 3);
    Reference run(m.rule, m.body, m.box);
    Body body = m.body;
    for (int step = 0; step < 60; ++step) {
      const std::vector<Vec3> f = plain_forces(m.rule, body, m.box);
      for (size_t i = 0; i < body.size(); ++i) {
        body.v[i] += f[i] * m.rule.dt;
        body.x[i] += body.v[i] * m.rule.dt;
      }
    }
    run.step(60);
    EXPECT_GT(run.lists_made(), 3u) << c.name;
    EXPECT_GT(difference(body.x, m.body.x), 0.5) << c.name;  // pitches: several skins
    // Rounding grows with the chaos of sixty steps; a pair that is missed in one shows as 1e-4 or more.
    EXPECT_LT(difference(run.body().x, body.x), 1e-9) << c.name;
  }
}

TEST(RealEngine, BitsDependOnNeitherThreadsNorLists) {
  for (const Case& c : cases())
    for (const Precision precision : {float64, float32}) {
      const Made m = made(c, 3);
      Reference one(m.rule, m.body, m.box, {.precision = precision});
      one.step(24);
      for (const int threads : {2, 3}) {
        Reference several(m.rule, m.body, m.box, {.precision = precision, .threads = threads});
        several.step(24);
        EXPECT_TRUE(same_bits(one.body(), several.body())) << c.name << ", threads " << threads;
      }
      // Lists, slots and skins of their own.
      Body body = m.body;
      for (int part = 0; part < 6; ++part) {
        Reference again(m.rule, body, m.box, {.precision = precision});
        again.step(4);
        body = again.body();
      }
      EXPECT_TRUE(same_bits(one.body(), body)) << c.name;
    }
}

TEST(RealEngine, BitsDependOnNoInstructionSet) {
  const int64_t all = hwy::SupportedTargets();
  size_t sets = 0;
  for (const Precision precision : {float64, float32})
    for (const Case& c : cases()) {
      const Made m = made(c, 1);
      std::vector<Body> ends;
      std::vector<std::string> names;
      for (int64_t left = all; left != 0; left &= left - 1) {
        hwy::SetSupportedTargetsForTest(left);
        hwy::GetChosenTarget().Update(left);
        Reference run(m.rule, m.body, m.box, {.precision = precision});
        run.step(10);
        ends.push_back(run.body());
        names.emplace_back(Reference::simd());
      }
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().Update(hwy::SupportedTargets());
      for (size_t k = 1; k < ends.size(); ++k)
        EXPECT_TRUE(same_bits(ends[0], ends[k])) << c.name << ' ' << names[k];
      sets = std::set<std::string>(names.begin(), names.end()).size();
    }
  if (sets < 2) GTEST_SKIP() << "this machine has one instruction set only";
}

TEST(RealEngine, OrderOfSumsIsDrawnFromItsSeed) {
  for (const Precision precision : {float64, float32}) {
    const Made m = made(cases()[0], 0.5);
    const auto after = [&](uint64_t seed, int threads) {
      Reference run(m.rule, m.body, m.box, {.precision = precision, .threads = threads, .order_seed = seed});
      run.step(20);
      return run.body();
    };
    const Body fixed = after(0, 1), a = after(1, 1), b = after(2, 1);
    EXPECT_TRUE(same_bits(a, after(1, 3)));
    EXPECT_FALSE(same_bits(a, b));
    EXPECT_FALSE(same_bits(a, fixed));
    // The order of eighteen additions moves a sum by some units in its last place.
    const double unit = precision == float64 ? 0x1p-53 : 0x1p-24;
    EXPECT_LT(difference(a.x, b.x), 1e4 * unit);
    EXPECT_GT(difference(a.x, b.x), 0.1 * unit);
  }
}

TEST(RealEngine, FloatsHoldFloats) {
  const Made m = made(cases()[0], 0.5);
  Reference run(m.rule, m.body, m.box, {.precision = float32});
  for (const uint64_t steps : {0, 3}) {
    run.step(steps);
    for (size_t i = 0; i < m.body.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(run.body().x[i][axis], static_cast<double>(static_cast<float>(run.body().x[i][axis])));
        EXPECT_EQ(run.body().v[i][axis], static_cast<double>(static_cast<float>(run.body().v[i][axis])));
      }
  }
}

TEST(RealEngine, TakesAnEmptyBodyAndOneParticle) {
  const Rule rule = test::simple_rule(preset_law("elastic", 1, 1), 1, 0.1);
  for (const Precision precision : {float64, float32}) {
    Reference none(rule, {}, {}, {.precision = precision, .threads = 3});
    none.step(30);
    EXPECT_EQ(none.potential_energy(), 0);
    Body body;
    body.x = {Vec3(1, 2, 3)};
    body.v = {Vec3(0.5, 0, 0)};
    body.type = {0};
    Reference one(rule, body, {}, {.precision = precision, .threads = 3});
    one.step(40);
    EXPECT_NEAR(one.body().x[0].x(), 3, 1e-5);
    EXPECT_EQ(one.forces()[0], Vec3::Zero());
  }
}

TEST(RealEngine, FloatsStopWhereAPositionIsLost) {
  Made m = made(cases()[0], 0);
  m.body.v[5].y() = 1e38;
  m.rule.dt = 100;
  Reference run(m.rule, m.body, m.box, {.precision = float32});
  EXPECT_EQ(refused_with<std::runtime_error>([&] { run.step(5); }),
            "step 0: particle 5 has no finite position; is dt too long?");
}

}  // namespace
}  // namespace cuboct
