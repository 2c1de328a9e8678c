// SPDX-License-Identifier: MIT
// A law for each pair of materials: in integers, in the golden engine, and as a laminate.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/contract/golden.h"
#include "model/contract/law.h"
#include "model/contract/quantise.h"
#include "model/real/reference.h"
#include "model/solid/dynamical_matrix.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

Scene three_laws() { return test::block_scene({.two_materials = true, .laws = true}); }

TEST(Laws, ShareShapeAndUnitAndTellTheirErrors) {
  const Rule rule = three_laws().rule;
  for (const auto shape : {TableChoice::Shape::uniform, TableChoice::Shape::octaves})
    for (const int degree : {1, 2}) {
      const FixedRule fixed = quantise(rule, 1.7, {}, {.shape = shape, .degree = degree, .index_bits = 8});
      EXPECT_TRUE(fixed.scaled);
      EXPECT_EQ(fixed.law_bits, 2);
      EXPECT_EQ(fixed.law, rule.law_index);
      EXPECT_EQ(fixed.force.c0.size(), 3u << 8);
      ASSERT_EQ(fixed.errors.size(), 3u);
      const double unit = std::ldexp(1.0, -fixed.force.value_frac) / (rule.dt * rule.dt);
      std::mt19937_64 random(3);
      for (uint32_t n = 0; n < 3; ++n) {
        const PairLaw& law = rule.law_at(n);
        double worst = 0;
        for (int k = 0; k < 200000; ++k) {
          const uint64_t r2 = random() % fixed.cutoff2;
          const double r = std::sqrt(std::ldexp(static_cast<double>(r2), -32)) * 1.7;
          if (r < law.core()) continue;
          worst =
              std::max(worst, std::abs(static_cast<double>(fixed.force.at(r2, n)) * unit * r - law.force(r)));
        }
        // The report samples each bin at 64 points: at the kink of the core, where the slope jumps by less
        // than 1, a 64th of a bin lies between, and of all entries half a unit.
        const double kink = 1.7 * 1.7 / 256 / 64 / (2 * law.core());
        EXPECT_LE(worst, 1.05 * fixed.errors[n].worst_force + unit + kink) << n;
        EXPECT_GE(worst, 0.5 * fixed.errors[n].worst_force - unit) << n;
        EXPECT_LE(fixed.errors[n].worst_force, fixed.error().worst_force);
      }
    }
}

// The strongest, longest law sets the unit: its pairs have the kicks that they have alone, to the last
// bit.
TEST(Laws, KicksOfTheFirstAreThoseOfItAlone) {
  Scene scene = three_laws();
  Widths widths;
  widths.strength_bits = 22;  // chosen by itself it is that of the weakest law
  const TableChoice uniform{.shape = TableChoice::Shape::uniform, .index_bits = 9};
  const FixedRule several = quantise(scene.rule, 1.7, widths, uniform);
  scene.rule.other_laws.clear();
  scene.rule.law_index.clear();
  const FixedRule alone = quantise(scene.rule, 1.7, widths, uniform);
  ASSERT_EQ(several.force.value_frac, alone.force.value_frac);
  std::mt19937_64 random(3);
  const int64_t P = int64_t{1} << several.widths.position_frac;
  int same = 0, other = 0;
  for (int k = 0; k < 50000; ++k) {
    Int3 xi, xj, vi, vj;
    for (int a = 0; a < 3; ++a) {
      xi[a] = static_cast<int64_t>(random() % P), xj[a] = static_cast<int64_t>(random() % P);
      vi[a] = static_cast<int64_t>(random() % 4096), vj[a] = static_cast<int64_t>(random() % 4096);
    }
    ASSERT_EQ(pair_kick(several, xi, vi, 0, xj, vj, 0).kick, pair_kick(alone, xi, vi, 0, xj, vj, 0).kick);
    const PairResult own = pair_kick(several, xi, vi, 0, xj, vj, 1),
                     back = pair_kick(several, xj, vj, 1, xi, vi, 0);
    for (int a = 0; a < 3; ++a) ASSERT_EQ(own.kick[a], -back.kick[a]);
    ++(own.kick == pair_kick(alone, xi, vi, 0, xj, vj, 1).kick ? same : other);
  }
  EXPECT_GT(other, 10000);
}

// Golden's forces beside those of doubles, at the positions that golden sees: each of at most 18 near pairs
// errs by its table and by the rounding of differences, half a unit along each axis at either end of the
// slope 2.
TEST(Laws, GoldenIsTheReferenceWithinItsTables) {
  const Scene scene = three_laws();
  const auto setup = make_setup(scene, {});
  const FixedRule& rule = setup.plan.rule;
  Golden golden(rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  golden.step();
  const State next = golden.state();
  const Body body = to_real(setup.initial, rule, setup.plan.lattice, setup.plan.origin);
  const Reference reference(scene.rule, body, {});
  const std::vector<Vec3> expected = reference.forces();
  const double bound =
      18 * (rule.error().worst_force + 4 * std::ldexp(rule.cell_edge, -rule.widths.difference_frac));
  double largest = 0;
  for (const Particle& before : setup.initial.particles) {
    const Particle& after = next.particles[before.id];
    for (int a = 0; a < 3; ++a) {
      const double force =
          std::ldexp(static_cast<double>(after.v[a] - before.v[a]), -rule.widths.velocity_frac()) *
          rule.cell_edge / (rule.dt * rule.dt);
      EXPECT_NEAR(force, expected[before.id][a], bound) << before.id;
      largest = std::max(largest, std::abs(force));
    }
  }
  EXPECT_GT(largest, 5 * bound);
}

TEST(Laws, OneThatIsZeroIsTold) {
  Rule rule = three_laws().rule;
  rule.other_laws[1] = std::make_shared<test::BondLaw>(0, 1.3);
  EXPECT_EQ(refused_with([&] { quantise(rule, 1.7, {}, {}); }),
            "the pair law 3 of 3 is zero everywhere inside its cutoff");
}

// --- A laminate --------------------------------------------------------------------------------------------

constexpr int kPlanes = 6;  // of each material in a period along z
constexpr double kSmallStrain = 1e-5;

// A periodic FCC crystal whose (001) planes are by turns stiff and soft.
Scene laminate(double stiff, double soft, double interface) {
  const std::string half = fmt::format("{}", kPlanes / 2 * std::sqrt(2.0) - 0.1);
  return parse_scene(fmt::format(R"(
units = "reduced"
mass = 1.0
[packing]
pitch = 1.0
[box]
cells = [3, 3, {}]
periodic = "xyz"
[law]
kind = "elastic"
stiffness = {}
[damping]
ratio = 0.3
[[material]]
name = "stiff"
[[material]]
name = "soft"
region = {{ shape = "half_space", point = [0, 0, {}], normal = "-z" }}
[[bond]]
between = ["soft", "soft"]
law = {{ kind = "elastic", stiffness = {} }}
[[bond]]
between = ["stiff", "soft"]
law = {{ kind = "elastic", stiffness = {} }}
[run]
steps = 1
)",
                                 kPlanes, stiff, half, soft, interface),
                     "laminate.toml");
}

// Mean stress at rest of the crystal strained by `strain` along each axis.
Vec3 stress_of(Scene scene, const Vec3& strain) {
  for (Vec3& x : scene.body.x) x += strain.cwiseProduct(x);
  scene.periodic.extent += strain.cwiseProduct(scene.periodic.extent);
  Reference run(scene.rule, scene.body, scene.periodic);
  run.step(8000);
  double largest = 0;
  for (const Vec3& f : run.forces()) largest = std::max(largest, f.norm());
  EXPECT_LT(largest, 1e-7 * kSmallStrain * -scene.rule.law->slope(1));
  Vec3 mean = Vec3::Zero();
  const std::vector<Mat3> stress = run.virial_stress(fcc_volume(1));
  for (const Mat3& of : stress) mean += of.diagonal() / static_cast<double>(stress.size());
  return mean;
}

// c of each law's own packing: C11 = 2 c, C12 = c (scene_parts.h).
double c_of(const PairLaw& law) { return elastic_constants(law, 1)(0, 0) / 2; }

// Neighbouring (001) planes are tied by bonds between the two alone, and a strain along z is one displacement
// of planes: the gaps between planes are springs in a row. So across the layers 1/C33 is the mean of 1/(2 c)
// over the gaps, which is Reuss with the two interfaces as a third phase: exact in the lattice. Along the
// layers, with the stress across them 0, each plane's own bonds give c and each gap's c/2 (of c ex^2 + c (ex
// + ez)^2 + c ez^2 at its least, ez = -ex/2): Voigt's mean, planes and gaps apart, again exact. Left is the
// strain e = 1e-5 in the stress: its volume and the lengths of its bonds are off by e and 2 e. No slope
// changes in first order. 5 e holds all.
TEST(Laws, LaminateIsReussAcrossAndVoigtAlongItsLayers) {
  for (const double interface : {0.7, 8.0 / 5}) {  // of its own; the harmonic mean of the two
    const Scene scene = laminate(4, 1, interface);
    ASSERT_EQ(scene.rule.laws(), 3u);
    ASSERT_EQ(scene.body.size(), size_t{9 * 4 * kPlanes});
    const double stiff = c_of(scene.rule.law_at(0)), soft = c_of(scene.rule.law_at(1)),
                 between = c_of(scene.rule.law_at(2));
    EXPECT_NEAR(stiff, 4 / std::sqrt(2), 1e-9);
    const double n = kPlanes, inner = n - 1, period = 2 * n;
    const double reuss = 2 * period / (inner / stiff + inner / soft + 2 / between);
    const double voigt = (stiff + soft) / 2 + (inner * stiff + inner * soft + 2 * between) / period / 2;
    const Vec3 across = stress_of(scene, kSmallStrain * Vec3::UnitZ()) / kSmallStrain,
               along = stress_of(scene, kSmallStrain * Vec3::UnitX()) / kSmallStrain;
    EXPECT_NEAR(across.z(), reuss, 5 * kSmallStrain * reuss);
    EXPECT_NEAR(along.x() - across.x() * along.z() / across.z(), voigt, 5 * kSmallStrain * voigt);
    if (interface != 8.0 / 5) continue;
    // Two gaps of the harmonic mean are one of each phase: then Reuss is that of the two phases alone.
    // Voigt's differs from theirs by what the interfaces lack, (arithmetic - harmonic mean)/2 in 1 of n
    // gaps: 4.2 % of it here.
    EXPECT_NEAR(across.z(), 2 * 2 / (1 / stiff + 1 / soft), 5 * kSmallStrain * reuss);
    const double whole = 1.5 * (stiff + soft) / 2;
    EXPECT_NEAR(voigt, whole - ((stiff + soft) / 2 - between) / 2 / n, 1e-9);
    EXPECT_LT(voigt, whole);
    EXPECT_GT(voigt, 0.95 * whole);
  }
}

}  // namespace
}  // namespace cuboct
