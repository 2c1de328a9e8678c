// SPDX-License-Identifier: MIT
// Forces, energy and damage of the linear peridynamic solid, by hand and by differences.
#include "model/rules/lps.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "tests/rules/lps_body.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using test::cubic_block;
using test::cubic_material;
using test::LpsBody;

std::vector<Vec3> shaken(std::vector<Vec3> x, double by) {
  std::mt19937 dice(7);
  std::normal_distribution<double> noise(0, by);
  for (Vec3& at : x) at += Vec3(noise(dice), noise(dice), noise(dice));
  return x;
}

// Two directions of pull, three kinds of sums: -dE/dx by central differences. With a step of 1e-5 of a
// spacing they err by 1e-10 of the curvature and by rounding of the energy, 1e-16/1e-5.
TEST(Lps, ForceIsTheSlopeOfTheEnergy) {
  const Body body = cubic_block(4, 4, 4);
  size_t compared = 0;
  for (const bool finite : {true, false})
    for (const auto quadrature : {LpsQuadrature::points, LpsQuadrature::partial}) {
      LpsMaterial m = cubic_material();
      m.finite = finite, m.quadrature = quadrature;
      LpsBody lps(m, simple_cubic_bonds(1, 3), body);
      const std::vector<Vec3> x = shaken(body.x, 0.02);
      const std::vector<Vec3> f = lps.forces(x);
      for (const size_t i : {0, 21, 63})
        for (int axis = 0; axis < 3; ++axis, ++compared) {
          constexpr double kStep = 1e-5;
          std::vector<Vec3> y = x;
          y[i][axis] += kStep;
          lps.forces(y);
          const double above = lps.terms().energy();
          y[i][axis] -= 2 * kStep;
          lps.forces(y);
          EXPECT_NEAR(f[i][axis], (lps.terms().energy() - above) / (2 * kStep), 1e-8)
              << i << " " << axis << " finite " << finite;
        }
    }
  EXPECT_EQ(compared, 36u);
}

TEST(Lps, ForcesBalanceAndATurnedBodyIsAtRest) {
  const Body body = cubic_block(4, 5, 4);
  LpsBody lps(cubic_material(), simple_cubic_bonds(1, 3), body);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  const std::vector<Vec3> x = shaken(body.x, 0.05);
  const std::vector<Vec3> f = lps.forces(x);
  double scale = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    sum += f[i], moment += x[i].cross(f[i]), scale += f[i].norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * scale);
  EXPECT_LT(moment.norm(), 1e-12 * scale);
  std::vector<Vec3> turned;
  const Mat3 turn = Eigen::AngleAxisd(1.1, eigen(Vec3(1, 2, 3).normalized())).toRotationMatrix();
  for (const Vec3& at : body.x) turned.push_back(turn * at + Vec3(5, 6, 7));
  for (const Vec3& at : lps.forces(turned)) EXPECT_LT(at.norm(), 1e-12);
}

// Equal stretch s of all has the stress 3 K s, exactly, where all that a particle reaches reaches as far.
TEST(Lps, EqualStretchHasTheEnergyOfItsBulkModulus) {
  const Body body = cubic_block(13, 13, 13);
  for (const double influence : {0.0, 3.0}) {
    LpsMaterial m = cubic_material();
    m.influence = influence, m.finite = false;
    LpsBody lps(m, simple_cubic_bonds(1, 3), body);
    constexpr double kStretch = 1e-3;
    std::vector<Vec3> x = body.x;
    for (Vec3& at : x) at *= 1 + kStretch;
    lps.forces(x);
    const Mat3 stress = lps.terms().stress((6 * 13 + 6) * 13 + 6, m.volume);
    EXPECT_NEAR(stress(0, 0), 3 * m.bulk() * kStretch, 1e-13);
    EXPECT_NEAR(stress(1, 1), 3 * m.bulk() * kStretch, 1e-13);
    EXPECT_NEAR(stress(0, 1), 0, 1e-15);
  }
}

// Equation 22: a bond of stretch s0 has half its force left, and what is left never grows.
TEST(Lps, DamageIsSmoothAndNeverHeals) {
  LpsMaterial m = cubic_material();
  m.critical_stretch = 0.1, m.damage_width = 0.01;
  const Body body = cubic_block(4, 4, 4);
  LpsBody lps(m, simple_cubic_bonds(1, 3), body);
  const auto stretched = [&](double s) {
    std::vector<Vec3> x = body.x;
    for (Vec3& at : x) at *= 1 + s;
    return x;
  };
  lps.forces(stretched(0.1), false);
  EXPECT_EQ(lps.terms().damage()[21], 0);  // looked at, not stepped
  lps.forces(stretched(0.1), true);
  EXPECT_NEAR(lps.terms().damage()[21], 0.5, 1e-9);
  lps.forces(stretched(0.0), true);
  EXPECT_NEAR(lps.terms().damage()[21], 0.5, 1e-9);
  lps.forces(stretched(0.11), true);
  EXPECT_NEAR(lps.terms().damage()[21], (1 + std::tanh(1.0)) / 2, 1e-9);
  lps.forces(stretched(0.5), true);
  EXPECT_EQ(lps.terms().damage()[21], 1);
  for (const Vec3& f : lps.forces(stretched(0.2))) EXPECT_EQ(f, Vec3(Vec3::Zero()));
}

TEST(Lps, BondsKeepTheirDamageThroughACheckpoint) {
  LpsMaterial m = cubic_material();
  m.critical_stretch = 0.02, m.damage_width = 0.01;
  const Body body = cubic_block(4, 4, 4);
  const auto full = simple_cubic_bonds(1, 3);
  const LpsRule rule(m, full);
  LpsBody first(m, full, body);
  const std::vector<Vec3> x = shaken(body.x, 0.02);
  first.forces(x, true);
  auto other = rule.bind({}, body, {}, 1);
  EXPECT_THROW(other->recall({1, 2, 3}), InputError);
  other->recall(first.terms().memory());
  EXPECT_EQ(other->memory(), first.terms().memory());
  double damaged = 0;
  for (size_t i = 0; i < body.size(); ++i) {
    EXPECT_EQ(other->damage()[i], first.terms().damage()[i]);
    damaged += other->damage()[i];
  }
  EXPECT_GT(damaged, 1);
}

// Closed forms of the ball: w = 1: 8 G0/(15 K h); w = 1/r: 5 G0/(9 K h); in two dimensions with w = 1,
// G0 = 8 K s^2/m times h^5/5, m = 2 pi h^4/4.
// Bernstein's polynomials sum to 1, so that equal coefficients scale the power alone. The integral of the
// weight over the horizon is that of 20,000 rings of a disc: a midpoint sum, off by some 1e-8.
TEST(Lps, BernsteinWeightsAreWhatIsIntegrated) {
  LpsMaterial m = cubic_material();
  m.dimensions = 2, m.quadrature = LpsQuadrature::fitted;
  const double plain = m.weight(1.7);
  m.bernstein = {2, 2, 2, 2};
  EXPECT_NEAR(m.weight(1.7), 2 * plain, 1e-14);
  m.bernstein = {1.5, -0.3, 0.8, 0.2};
  double rings = 0;
  constexpr int kRings = 20000;
  for (int k = 0; k < kRings; ++k) {
    const double r = (k + 0.5) * m.horizon / kRings;
    rings += 2 * M_PI * r * m.weight(r) * r * r * m.horizon / kRings;
  }
  EXPECT_NEAR(full_weight(m, {}) / rings, 1, 1e-7);
}

TEST(Lps, CriticalStretchIsThatOfTheFractureEnergy) {
  LpsMaterial m = cubic_material();
  const double energy = 1e-3;
  m.influence = 0;
  EXPECT_NEAR(critical_stretch(m, {}, energy), std::sqrt(8 * energy / (15 * m.bulk() * m.horizon)), 1e-12);
  m.influence = 1;
  EXPECT_NEAR(critical_stretch(m, {}, energy), std::sqrt(5 * energy / (9 * m.bulk() * m.horizon)), 1e-12);
  m.dimensions = 2, m.influence = 0;
  const double h = m.horizon, pi = 3.14159265358979323846;
  EXPECT_NEAR(critical_stretch(m, {}, energy),
              std::sqrt(energy * (2 * pi * std::pow(h, 4) / 4) / (8 * m.bulk() * std::pow(h, 5) / 5)), 1e-12);
  // On a lattice the sums take the integrals' place: within a few percent of them at three spacings.
  m = cubic_material();
  EXPECT_NEAR(critical_stretch(m, simple_cubic_bonds(1, 3), energy) / critical_stretch(m, {}, energy), 1,
              0.05);
}

// A slit cuts the bonds through its parallelogram, and no others.
TEST(Lps, SlitsCutWhatPassesThroughThem) {
  const Body body = cubic_block(4, 4, 4);
  const Slit half{Vec3(1.5, -1, -1), Vec3(0, 2.5, 0), Vec3(0, 0, 6)};  // x = 1.5, y < 1.5
  const ReferenceBonds whole = reference_bonds(body.x, {}, 1), cut = reference_bonds(body.x, {}, 1, {half});
  EXPECT_EQ(whole.other.size(), 2u * 3 * 48);
  EXPECT_EQ(cut.other.size(), 2u * (3 * 48 - 2 * 4));
}

std::string refusal(const LpsMaterial& m, const Body& body) {
  return refused_with([&] { LpsBody lps(m, simple_cubic_bonds(1, 3), body); });
}

TEST(Lps, BadMaterialsAndBodiesAreRefusedWithTheirPlace) {
  LpsMaterial m = cubic_material();
  Body body = cubic_block(2, 2, 2);
  body.x.push_back(Vec3(9, 9, 9));
  EXPECT_NE(refusal(m, body).find("particle 8 at (9, 9, 9) m has 0 bonds within the horizon of 3 m"),
            std::string::npos)
      << refusal(m, body);
  EXPECT_NE(refusal(m, cubic_block(4, 4, 1)).find("which do not span 3 dimensions"), std::string::npos);
  m.mu = -1;
  EXPECT_NE(refusal(m, cubic_block(2, 2, 2)).find("shear modulus -1 Pa"), std::string::npos);
  m = cubic_material();
  m.lambda = -1;
  EXPECT_NE(refusal(m, cubic_block(2, 2, 2)).find("bulk modulus"), std::string::npos);
  m = cubic_material();
  m.influence = 5;
  EXPECT_NE(refusal(m, cubic_block(2, 2, 2)).find("infinite"), std::string::npos);
  m = cubic_material();
  m.corrected = true;
  EXPECT_NE(refusal(m, cubic_block(2, 2, 2)).find("small displacements"), std::string::npos);
  LpsBody lps(cubic_material(), simple_cubic_bonds(1, 3), cubic_block(3, 3, 3));
  std::vector<Vec3> x = cubic_block(3, 3, 3).x;
  x[5][1] = std::nan("");
  EXPECT_THROW(lps.forces(x), std::runtime_error);
}

}  // namespace
}  // namespace cuboct
