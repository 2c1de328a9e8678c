// SPDX-License-Identifier: MIT
// Energies of cleavage: closed forms of the packing, and the bonds of a block that is cut.
#include "model/solid/cleavage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "model/contract/law.h"
#include "tests/fcc_block.h"
#include "tests/fcc_cell.h"

namespace cuboct {
namespace {

// A site has the volume pitch^3/sqrt(2). Of the nearest neighbours' bonds, all of depth U, a plane cuts per
// pitch^2: {100} four that rise by pitch/sqrt(2), {110} one by pitch and four by half of it, {111} three by
// sqrt(2/3) pitch, {210} six by 3, 2, 2, 1, 1 and 1 pitch/sqrt(10).
TEST(Cleavage, OfNearestNeighboursIsTheClosedForm) {
  constexpr double kPitch = 1e-3;
  Rule rule = test::simple_rule(preset_law("brittle", kPitch, 3e5), 1, 1);
  rule.strength = {{2.0}};
  const CrystalCell cell = test::primitive_fcc(kPitch);
  const double unit = -2 * rule.law->energy(kPitch) / (kPitch * kPitch);
  EXPECT_NEAR(-rule.law->energy(kPitch) / (3e5 * kPitch * kPitch), 0.0024,
              5e-5);  // docs/reference/physics.md
  const auto expect = [&](const Vec3& n, double bonds) {
    EXPECT_NEAR(cleavage_energy(rule, cell, n), bonds * unit, 1e-9 * bonds * unit) << n;
  };
  expect({1, 0, 0}, 4);
  expect({1, 1, 0}, 3 * std::sqrt(2.0));
  expect({1, -1, 1}, 2 * std::sqrt(3.0));
  expect({0, 2, 1}, 2 * std::sqrt(5.0));
  const CleavagePlanes planes = cleavage_planes(rule, cell);
  expect(planes.weakest, 2 * std::sqrt(3.0));
  expect(planes.strongest, 2 * std::sqrt(5.0));
  EXPECT_NEAR(planes.weakest.cwiseAbs().minCoeff(), 1 / std::sqrt(3.0), 1e-9);
}

// Second and third shells too: pairs of a finite block across a plane between its sites, far from its faces.
TEST(Cleavage, OfLongerLawsIsThatOfABlockThatIsCut) {
  const Rule rule = test::simple_rule(lennard_jones(1, 1, 2.0, 0.8), 1, 1);
  const CrystalCell cell = test::primitive_fcc(1.1);
  const double edge = 1.1 * std::numbers::sqrt2;
  const Periodic box = test::fcc_box(4, 1.1);
  const Body body = test::fcc_block(4, 1.1);
  double sum = 0;
  for (const Vec3& a : body.x)
    for (const Vec3& b : body.x) {
      Vec3 d = b - a;
      for (int k = 1; k < 3; ++k) d[k] -= box.extent[k] * std::round(d[k] / box.extent[k]);
      if (a.x() < 1.75 * edge && b.x() > 1.75 * edge) sum -= rule.pair_energy(0, 0, d.norm());
    }
  const double area = box.extent.y() * box.extent.z();
  EXPECT_NEAR(cleavage_energy(rule, cell, Vec3::UnitX()), sum / area, 1e-9 * sum / area);
}

// No plane is weaker than the weakest, nor stronger than the strongest.
TEST(Cleavage, ExtremesBoundRandomPlanes) {
  const Rule rule = test::simple_rule(lennard_jones(1, 1, 2.0, 0.8), 1, 1);
  const CrystalCell cell = test::primitive_fcc(1.1);
  const CleavagePlanes planes = cleavage_planes(rule, cell);
  const double low = cleavage_energy(rule, cell, planes.weakest);
  const double high = cleavage_energy(rule, cell, planes.strongest);
  std::mt19937_64 generator(3);
  double least = high, most = low;
  for (int k = 0; k < 2000; ++k) {
    const double energy = cleavage_energy(rule, cell, test::random_vector(generator));
    least = std::min(least, energy), most = std::max(most, energy);
  }
  EXPECT_GE(least, low * (1 - 1e-9));
  EXPECT_LE(most, high * (1 + 1e-9));
  EXPECT_LT(least, low * 1.03);
  EXPECT_GT(most, high * 0.97);
}

}  // namespace
}  // namespace cuboct
