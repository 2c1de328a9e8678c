// SPDX-License-Identifier: MIT
// Moduli and waves of the peridynamic solid on lattices: what a pair law cannot do, and where a common choice
// of horizon is wrong. References: shared closed forms, C44/G = 15 <nx^2 ny^2> and C'/G = (15/4) <(nx^2 -
// ny^2)^2>, means weighted with w r^2.
#include "model/rules/lps_lattice.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "tests/rules/lps_body.h"

namespace cuboct {
namespace {

LpsMaterial of_ratio(double nu, double horizon, double influence, double volume) {
  LpsMaterial m;
  m.mu = 1, m.lambda = 2 * nu / (1 - 2 * nu);
  m.horizon = horizon, m.influence = influence, m.volume = volume, m.spacing = 1;
  return m;
}
const double kFccVolume = 1 / std::sqrt(2.0);

struct Case {
  const char* name;
  std::vector<Vec3> full;
  double horizon, influence, volume, shear, prime;  // over G
};
std::vector<Case> cases() {
  return {{"cubic, 122, w = 1", simple_cubic_bonds(1, 3), 3, 0, 1, 1.1102, 0.8347},
          {"cubic, 122, w = 1/r", simple_cubic_bonds(1, 3), 3, 1, 1, 1.0862, 0.8706},
          {"cubic, 18, w = 1", simple_cubic_bonds(1, 1.5), 1.5, 0, 1, 1.0, 1.0},
          {"FCC, 12", fcc_bonds(1, 1.1), 1.1, 0, kFccVolume, 1.25, 0.625},
          {"FCC, 18, w = 1", fcc_bonds(1, 1.5), 1.5, 0, kFccVolume, 0.625, 1.5625},
          {"FCC, 18, w = 1/r^4", fcc_bonds(1, 1.5), 1.5, 4, kFccVolume, 1.0, 1.0},
          {"FCC, 42, w = 1/r^2", fcc_bonds(1, 1.8), 1.8, 2, kFccVolume, 1.0714, 0.8929},
          {"FCC, 78, w = 1/r^4", fcc_bonds(1, 2.3), 2.3, 4, kFccVolume, 1.0036, 0.9946}};
}

// To the four decimals of the closed forms. The bulk modulus is exact on every lattice.
TEST(LpsLattice, ShearModuliAreThoseOfTheClosedForms) {
  for (const Case& of : cases()) {
    const LpsMaterial m = of_ratio(0.3, of.horizon, of.influence, of.volume);
    const CubicModuli c = lattice_moduli(m, of.full);
    EXPECT_NEAR(c.shear() / m.mu, of.shear, 6e-5) << of.name;
    EXPECT_NEAR(c.prime() / m.mu, of.prime, 6e-5) << of.name;
    EXPECT_NEAR(c.bulk() / m.bulk(), 1, 1e-13) << of.name;
  }
}

// The moduli are those of the force: a cell strained evenly, by the engine's own terms.
TEST(LpsLattice, ModuliAreThoseOfAStrainedBlock) {
  const int n = 13;
  const Body body = test::cubic_block(n, n, n);
  LpsMaterial m = of_ratio(0.1, 3, 0, 1);
  m.finite = false;
  const std::vector<Vec3> full = simple_cubic_bonds(1, 3);
  const CubicModuli c = lattice_moduli(m, full);
  test::LpsBody lps(m, full, body);
  constexpr double kStrain = 1e-3;
  std::vector<Vec3> x = body.x;
  for (Vec3& at : x) at += kStrain * Vec3(at[0], at[2], at[1]);  // e_xx and 2 e_yz
  lps.forces(x);
  const Mat3 stress = lps.terms().stress(static_cast<size_t>((6 * n + 6) * n + 6), m.volume);
  EXPECT_NEAR(stress(0, 0), c.c11 * kStrain, 1e-12 * c.c11);
  EXPECT_NEAR(stress(1, 1), c.c12 * kStrain, 1e-12 * c.c11);
  EXPECT_NEAR(stress(1, 2), 2 * c.c44 * kStrain, 1e-12 * c.c11);
}

// FCC with 18 neighbours and 1/r^4: the same speeds in every direction, for any Poisson's ratio.
TEST(LpsLattice, LongWavesAreIsotropicForAnyRatio) {
  std::mt19937 dice(3);
  std::normal_distribution<double> normal;
  for (const double nu : {-0.5, 0.0, 0.25, 0.33, 0.45, 0.49}) {
    const LpsMaterial m = of_ratio(nu, 1.5, 4, kFccVolume);
    const std::vector<Vec3> full = fcc_bonds(1, 1.5);
    for (int k = 0; k < 50; ++k) {
      const Vec3 n = Vec3(normal(dice), normal(dice), normal(dice)).normalized();
      constexpr double kWave = 1e-3;  // the next term is (k r)^2/12, 1e-7
      const Eigen::SelfAdjointEigenSolver<Mat3> solver(wave_matrix(m, full, kWave * n) / (kWave * kWave));
      EXPECT_NEAR(solver.eigenvalues()[0], m.mu, 1e-6);
      EXPECT_NEAR(solver.eigenvalues()[1], m.mu, 1e-6);
      EXPECT_NEAR(solver.eigenvalues()[2] / (m.lambda + 2 * m.mu), 1, 1e-6);
    }
  }
}

// Stable: no wave has a negative square of its frequency, shorter than any sample's neighbours too.
TEST(LpsLattice, NoWaveGrows) {
  std::mt19937 dice(4);
  std::uniform_real_distribution<double> flat(-7, 7);
  size_t waves = 0;
  for (const double nu : {-0.5, 0.0, 0.25, 0.49})
    for (int k = 0; k < 1000; ++k, ++waves) {
      const LpsMaterial m = of_ratio(nu, 1.5, 4, kFccVolume);
      const Vec3 wave(flat(dice), flat(dice), flat(dice));
      static const std::vector<Vec3> full = fcc_bonds(1, 1.5);
      EXPECT_GT(Eigen::SelfAdjointEigenSolver<Mat3>(wave_matrix(m, full, wave)).eigenvalues()[0], 0);
    }
  EXPECT_EQ(waves, 4000u);
}

}  // namespace
}  // namespace cuboct
