// SPDX-License-Identifier: MIT
// Elastic constants of cells: closed forms, published constants, and lattice sums beside strained
// simulations.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "model/analysis/scene_cell.h"
#include "model/analysis/strained_cell.h"
#include "model/base/mat3.h"
#include "model/contract/law.h"
#include "model/solid/moduli.h"
#include "tests/fcc_block.h"
#include "tests/fcc_cell.h"

namespace cuboct {
namespace {

constexpr double kStrain = 1e-6;

// The largest difference over the largest constant.
double difference(const Matrix6& a, const Matrix6& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

Matrix6 by_strain(const Rule& rule, const CrystalCell& cell) {
  uint64_t evaluations = 0;
  const Matrix6 c = constants_by_strain(rule, cell, kStrain, 1, evaluations);
  EXPECT_GT(evaluations, 0U);
  return c;
}

// One particle, whose cell is shorter than the cutoff, has the sums of the whole packing.
TEST(ElasticTensor, OfThePrimitiveCellIsThatOfThePacking) {
  for (const double pitch : {1.06, 1.12}) {  // under pressure, and pulled
    const Rule rule = test::simple_rule(lennard_jones(1, 1, 2.6, 0.8), 1, 1);
    const CrystalCell cell = test::primitive_fcc(pitch);
    const Matrix6 expected = elastic_constants(*rule.law, pitch);
    const ElasticTensor tensor = elastic_tensor(rule, cell);
    EXPECT_LT(difference(tensor.c, expected), 1e-12);
    EXPECT_NEAR(tensor.stress.trace() / -3, fcc_pressure(*rule.law, pitch), 1e-10);
    EXPECT_LT(difference(by_strain(rule, cell), expected), 1e-7);
  }
}

// Shared constants of the crystal at rest, cut at 2.5: by LAMMPS, which prints four digits and strains by
// 1e-6.
TEST(ElasticTensor, OfLennardJonesIsThePublishedOne) {
  const Rule rule = test::simple_rule(lennard_jones(1, 1, 2.5, 0.8), 1, 1);
  const CrystalCell cell = test::primitive_fcc(relaxed_pitch(*rule.law, 1.1));
  for (const Matrix6& c : {elastic_tensor(rule, cell).c, by_strain(rule, cell)}) {
    EXPECT_NEAR(c(0, 0), 97.71, 1e-3 * 97.71);
    EXPECT_NEAR(c(0, 1), 55.63, 1e-3 * 55.63);
    EXPECT_NEAR(c(3, 3), 55.63, 1e-3 * 55.63);
    EXPECT_NEAR(voigt_mean(c).bulk, 69.66, 1e-3 * 69.66);
  }
}

// Two materials of strength 1 and 4 in a random mixture, relaxed: particles give way within the cell, each
// differently, so that Born's term alone is far off.
TEST(ElasticTensor, OfAMixtureIsThatOfTheStrainedSimulation) {
  for (const int cells : {2, 4}) {  // 32 particles: dense; 256: sparse
    constexpr double kPitch = 1e-3;
    Rule rule = test::simple_rule(preset_law("elastic", kPitch, 100), 1, 1);
    rule.types.resize(2, rule.types[0]);
    rule.types[1].material = 1;
    rule.strength = {{1, 0.5}, {0.5, 4}};
    const Body body = test::fcc_block(cells, kPitch);
    CrystalCell cell;
    cell.vectors = diagonal(test::fcc_box(cells, kPitch).extent);
    cell.x = body.x;
    cell.type = body.type;
    std::mt19937_64 dice(7);
    for (uint8_t& type : cell.type) type = dice() >> 63;
    StrainedCell rest(rule, cell);
    rest.relax();
    const ElasticTensor tensor = elastic_tensor(rule, rest.cell());
    const Matrix6 strained = by_strain(rule, rest.cell());
    // Second neighbours that a strain brings within the cutoff push with its square: the strain times some
    // ten.
    EXPECT_LT(difference(tensor.c, strained), 5e-5) << cells;
    EXPECT_LT(tensor.residual, 1e-9 * 100 * kPitch);
    EXPECT_GT(difference(tensor.born, strained), 0.05) << cells;
    EXPECT_GT(softest_strain(tensor.c), 0);
  }
}

// A chain of bonds k1 and k2 in turn, side by side in no contact: the springs are in series.
TEST(ElasticTensor, OfTwoBondsInSeriesIsTheHarmonicMean) {
  Rule rule = test::simple_rule(preset_law("elastic", 1, 1), 1, 1);
  rule.types.resize(2, rule.types[0]);
  rule.types[1].material = 1;
  rule.strength = {{1, 3}, {3, 1}};
  // A A B B repeats: bonds AA 1, AB 3, BB 1, BA 3.
  CrystalCell cell;
  cell.vectors = diagonal({4, 10, 10});
  for (int i = 0; i < 4; ++i) cell.x.emplace_back(i, 0, 0), cell.type.push_back(i < 2 ? 0 : 1);
  const ElasticTensor tensor = elastic_tensor(rule, cell);
  // Per area 100: stiffness of a bond times its length over the area; the mean compliance is (1 + 1/3)/2.
  EXPECT_NEAR(tensor.c(0, 0), 1 / ((1 + 1.0 / 3) / 2) / 100, 1e-12);
  EXPECT_NEAR(tensor.born(0, 0), 2.0 / 100, 1e-12);
  EXPECT_NEAR(tensor.c(1, 1), 0, 1e-12);
}

// Nearest-neighbour bonds, faces across [100], free sides: E/E_bulk = 3a/(2 + a), a = (n - 1)/n the share of
// the bonds across layers that is left. (physics.md derives the same for a bar.)
TEST(ElasticTensor, OfASlabHasTheClosedForm) {
  const Scene scene = parse_scene(
      "units = \"reduced\"\nmass = 1.0\n[packing]\npitch = 1.0\n[geometry]\nshape = \"sphere\"\nradius = "
      "3.0\n"
      "[law]\nkind = \"ductile\"\nstiffness = 1.0\n[run]\nsteps = 1\n",
      "slab");
  const double bulk = youngs_modulus(elastic_constants(*scene.rule.law, 1), Vec3::UnitX());
  for (const int n : {2, 5, 16}) {
    const CrystalCell slab = without_stress(scene.rule, slab_of(scene, "", n), 1);
    EXPECT_EQ(slab.x.size(), static_cast<size_t>(2 * n));  // two in each layer of a cubic cell
    const double a = (n - 1.0) / n, expected = 3 * a / (2 + a) * bulk;
    EXPECT_NEAR(plane_modulus(elastic_tensor(scene.rule, slab).c), expected, 1e-9 * bulk) << n;
    if (n < 16) {
      EXPECT_NEAR(plane_modulus(by_strain(scene.rule, slab)), expected, 3e-5 * bulk) << n;
    }
  }
}

// A slab of Lennard-Jones relaxes: its layers part and its faces draw it together. The lattice sums agree
// with the simulation there too.
TEST(ElasticTensor, OfARelaxedLennardJonesSlabIsThatOfTheSimulation) {
  const Scene scene = parse_scene(
      "units = \"reduced\"\nmass = 1.0\n[packing]\npitch = \"relaxed\"\n[geometry]\nshape = \"sphere\"\n"
      "radius = 3.0\n[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\nsmooth = \"linear\"\n"
      "[run]\nsteps = 1\n",
      "slab");
  const CrystalCell cut = slab_of(scene, "", 4), slab = without_stress(scene.rule, cut, 1);
  EXPECT_LT(slab.vectors(0, 0), 0.999 * cut.vectors(0, 0));
  const double sums = plane_modulus(elastic_tensor(scene.rule, slab).c);
  EXPECT_NEAR(plane_modulus(by_strain(scene.rule, slab)), sums, 1e-5 * sums);
}

// An isotropic tensor, by Lame's constants, has its moduli in all directions.
TEST(Moduli, OfAnIsotropicBodyAreThoseOfLame) {
  constexpr double kLambda = 3, kMu = 2, kDensity = 0.5;
  Matrix6 c = Matrix6::Zero();
  c.topLeftCorner<3, 3>().setConstant(kLambda);
  for (int v = 0; v < 6; ++v) c(v, v) += v < 3 ? 2 * kMu : kMu;
  const double young = kMu * (3 * kLambda + 2 * kMu) / (kLambda + kMu);
  for (const Vec3& n : {Vec3(1, 0, 0), Vec3(1, -2, 0.5)}) {
    EXPECT_NEAR(youngs_modulus(c, n), young, 1e-12);
    const auto [low, high] = poissons_ratio(c, n);
    EXPECT_NEAR(low, kLambda / (2 * (kLambda + kMu)), 1e-12);
    EXPECT_NEAR(high, low, 1e-12);
    const Vec3 speeds = wave_speeds(c, kDensity, n);
    EXPECT_NEAR(speeds[0], std::sqrt(kMu / kDensity), 1e-12);
    EXPECT_NEAR(speeds[2], std::sqrt((kLambda + 2 * kMu) / kDensity), 1e-12);
  }
  EXPECT_NEAR(zener_ratio(c), 1, 1e-12);
  EXPECT_NEAR(universal_anisotropy(c), 0, 1e-12);
  EXPECT_NEAR(hill_mean(c).youngs(), young, 1e-12);
  EXPECT_NEAR(softest_strain(c), 2 * kMu, 1e-12);
}

// Cubic: Poisson's ratio under a pull along [110] is C12-like along [1-10] and [001] apart; extremes are
// <100> and <111>; a turned crystal has the same at the turned directions.
TEST(Moduli, OfACubicBodyTurnWithIt) {
  Matrix6 c = Matrix6::Zero();
  c.topLeftCorner<3, 3>().setConstant(1);
  for (int v = 0; v < 6; ++v) c(v, v) = v < 3 ? 2 : 1;
  EXPECT_NEAR(zener_ratio(c), 2, 1e-12);
  const Mat3 turn = (Mat3() << 1, 1, 0, -1, 1, 0, 0, 0, std::numbers::sqrt2).finished() / std::numbers::sqrt2;
  const Matrix6 turned = in_axes(c, turn.transpose());
  EXPECT_LT((in_axes(turned, turn) - c).norm(), 1e-12);
  EXPECT_NEAR(youngs_modulus(turned, turn * Vec3(1, 1, 1)), youngs_modulus(c, Vec3(1, 1, 1)), 1e-12);
  const auto [softest, stiffest] = extreme_directions(c);
  EXPECT_NEAR(youngs_modulus(c, softest), youngs_modulus(c, Vec3::UnitX()), 1e-9);
  EXPECT_NEAR(youngs_modulus(c, stiffest), youngs_modulus(c, Vec3(1, 1, 1)), 1e-9);
  // Pulled along [110]: S12 + (S11 - S12 - S44/2)/2 along [1-10] and S12 along [001], over -S along [110].
  const Matrix6 s = c.inverse();
  const double half = (s(0, 0) - s(0, 1) - s(3, 3) / 2) / 2, along = s(0, 0) - half;
  const auto [low, high] = poissons_ratio(c, Vec3(1, 1, 0));
  EXPECT_NEAR(low, std::min(-(s(0, 1) + half) / along, -s(0, 1) / along), 1e-12);
  EXPECT_NEAR(high, std::max(-(s(0, 1) + half) / along, -s(0, 1) / along), 1e-12);
  const Vec3 speeds = wave_speeds(c, 1, Vec3(1, 1, 0));  // (C11 - C12)/2, C44, (C11 + C12 + 2 C44)/2
  EXPECT_NEAR(speeds[0] * speeds[0], 0.5, 1e-12);
  EXPECT_NEAR(speeds[1] * speeds[1], 1, 1e-12);
  EXPECT_NEAR(speeds[2] * speeds[2], 2.5, 1e-12);
}

}  // namespace
}  // namespace cuboct
