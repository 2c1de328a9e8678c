// SPDX-License-Identifier: MIT
// A pair law of springs to shells: forces, constants by sums over bonds, and Cauchy's relation, which no pair
// law escapes.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "model/atoms/multiscale/sample_material.h"
#include "model/atoms/multiscale/shell_springs.h"
#include "model/base/error.h"
#include "model/solid/moduli.h"

namespace cuboct {
namespace {

constexpr double kSpringMass = 28.0855 * 1.66053906660e-27;     // kg
constexpr double kC11 = 165.6e9, kC12 = 63.4e9, kC44 = 78.1e9;  // Pa, about those of silicon

SampleMaterial material_of(Crystal crystal, const ShellSprings& springs, double edge) {
  return crystal_material(crystal, spring_law(springs), edge, 2, kSpringMass, 1e-9);
}

// Constants come from stresses of strains of 1e-4, so they are good to some 1e-6 of themselves.
TEST(SpringLaw, HasTheConstantsThatWereAskedAndCauchysRelation) {
  for (const auto& [crystal, edge] : {std::pair(Crystal::fcc, 4.31), {Crystal::diamond, 5.43}}) {
    const CauchyFit fit = cauchy_fit(kC11, kC12, kC44);
    const SampleMaterial m = material_of(crystal, springs_of(crystal, edge, fit), edge);
    EXPECT_EQ(m.lattice.place.size(), crystal == Crystal::fcc ? 32U : 64U);
    EXPECT_NEAR(m.edge(2), edge, 1e-6);
    for (const Matrix6& c : {m.constants, m.clamped}) {
      EXPECT_NEAR(c(0, 0), kC11, 1e-5 * kC11);
      EXPECT_NEAR(c(0, 1), fit.c44, 1e-5 * kC44);
      EXPECT_NEAR(c(3, 3), fit.c44, 1e-5 * kC44);
    }
    // With C12 = C44 = c Voigt's means are (C11 + 2c)/3 and (C11 + 2c)/5: a ratio of 1/4 for any such
    // crystal.
    EXPECT_NEAR(voigt_mean(m.constants).poisson(), 0.25, 1e-5);
  }
}

// Nailed atoms keep C44 = C12; those that may give way make it less.
TEST(SpringLaw, AtomsThatGiveWayOnlyLowerC44) {
  ShellSprings springs = springs_of(Crystal::diamond, 5.43, cauchy_fit(kC11, kC12, kC44));
  springs.shells.pop_back();
  const SampleMaterial m = material_of(Crystal::diamond, springs, 5.43);
  EXPECT_NEAR(m.clamped(3, 3), m.clamped(0, 1), 1e-5 * kC44);
  EXPECT_NEAR(m.constants(0, 1), m.clamped(0, 1), 1e-5 * kC44);
  EXPECT_LT(m.constants(3, 3), m.clamped(3, 3) - 1e9);
}

TEST(SpringLaw, FitIsTheLeastOfTheSquaresOfMisses) {
  const auto misses = [](double c) { return std::pow(c / kC12 - 1, 2) + std::pow(c / kC44 - 1, 2); };
  const CauchyFit fit = cauchy_fit(kC11, kC12, kC44);
  EXPECT_EQ(fit.c11, kC11);
  EXPECT_LT(misses(fit.c44), misses(fit.c44 * 1.001));
  EXPECT_LT(misses(fit.c44), misses(fit.c44 * 0.999));
}

// The force is the slope of the energy, and the virial that by a strain, far from rest and with a cell of any
// shape; central differences of 1e-5 leave an error of 1e-9.
TEST(SpringLaw, ForcesAreTheSlopeOfTheEnergy) {
  const ShellSprings springs = springs_of(Crystal::diamond, 5.43, cauchy_fit(kC11, kC12, kC44));
  const AtomicLattice lattice = crystal_lattice(Crystal::diamond, 5.43, 1, kSpringMass);
  const auto forces = spring_law(springs)->forces();
  Mat3 shear;
  shear << 1.01, 0.02, 0, 0, 0.98, 0.015, 0, 0, 1.02;
  const Mat3 cell = shear * lattice.cell;
  std::vector<Vec3> x, f(8), unused(8);
  for (size_t i = 0; i < 8; ++i)
    x.push_back(cell * lattice.place[i] +
                0.08 * Vec3(std::sin(3.0 * i), std::sin(5.0 * i + 1), std::cos(7.0 * i)));
  Mat3 virial, other;
  forces->evaluate(cell, x, f, virial);
  constexpr double kStep = 1e-5;
  for (size_t k = 0; k < 24; ++k) {
    std::vector<Vec3> moved = x;
    moved[k / 3][k % 3] += kStep;
    const double plus = forces->evaluate(cell, moved, unused, other);
    moved[k / 3][k % 3] -= 2 * kStep;
    EXPECT_NEAR(f[k / 3][k % 3], (forces->evaluate(cell, moved, unused, other) - plus) / (2 * kStep), 1e-7);
  }
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      std::array<double, 2> energy;
      for (const int side : {0, 1}) {
        Mat3 strain = Mat3::Identity();
        strain(a, b) += side == 0 ? kStep : -kStep;
        std::vector<Vec3> moved;
        for (const Vec3& at : x) moved.push_back(strain * at);
        energy[side] = forces->evaluate(strain * cell, moved, unused, other);
      }
      EXPECT_NEAR(virial(a, b), (energy[0] - energy[1]) / (2 * kStep), 1e-6);
    }
}

TEST(SpringLaw, RefusesConstantsThatNoSpringsHave) {
  EXPECT_THROW(springs_of(Crystal::fcc, 4, {100e9, 60e9}), InputError);      // C11 < 2 C44
  EXPECT_THROW(springs_of(Crystal::diamond, 5, {300e9, 60e9}), InputError);  // 60 < 7/9 (300 - 120)
  EXPECT_NO_THROW(springs_of(Crystal::fcc, 4, {300e9, 60e9}));
}

}  // namespace
}  // namespace cuboct
