// SPDX-License-Identifier: MIT
// Exact properties of diamond, and their slopes by the parameters, beside forces of atoms and differences.
#include "model/atoms/bond_order/diamond_properties.h"

#include <gtest/gtest.h>

#include <cmath>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/diamond_strain.h"

namespace cuboct {
namespace {

class DiamondOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Sets, DiamondOf,
                         testing::Values("si_erhart_albe", "si_multiscale", "si_1989", "c_1989"),
                         [](const auto& info) { return std::string(info.param); });

// constants_of takes differences of the forces' virial, whose own error is some 1e-8 of a constant.
TEST_P(DiamondOf, HasThePropertiesThatForcesSay) {
  const Tersoff tersoff = tersoff_set(GetParam());
  TersoffForces forces(tersoff);
  const AtomCell cell = at_no_pressure(forces, diamond_cell(tersoff.elements[0] == "C" ? 3.57 : 5.43));
  const CellConstants c = constants_of(forces, cell);
  const DiamondProperties is = diamond_properties(tersoff.terms[0], 2 * cell.box.edges(0, 1), false);
  const double bound = 1e-6 * c.relaxed(0, 0);
  EXPECT_NEAR(is.value[cohesive], c.energy, 1e-12 * std::abs(c.energy));
  EXPECT_NEAR(is.value[edge_slope], 0, 1e-9);
  EXPECT_NEAR(is.value[bulk], (c.relaxed(0, 0) + 2 * c.relaxed(0, 1)) / 3, bound);
  EXPECT_NEAR(is.value[c_prime], (c.relaxed(0, 0) - c.relaxed(0, 1)) / 2, bound);
  EXPECT_NEAR(is.value[c11], c.relaxed(0, 0), bound);
  EXPECT_NEAR(is.value[c12], c.relaxed(0, 1), bound);
  EXPECT_NEAR(is.value[c44_clamped], c.clamped(3, 3), bound);
  EXPECT_NEAR(is.value[c44], c.relaxed(3, 3), bound);
  EXPECT_GT(is.inner, 0);
}

double energy_at(const TersoffTerm<double>& term, const BondPath& path, double t) {
  BondPath there = path;
  for (size_t j = 0; j < 4; ++j) there.at[j] += t * path.rate[j];
  return path_energy(term, there).energy;
}

// A path without symmetry, bonds within the fall of the cutoff, lambda3 of both powers: the slopes beside
// differences of the energy. Steps of 1e-4: errors of 1e-8 of the next derivatives but one, and rounding.
TEST(DiamondStrain, SlopesAreThoseOfTheEnergy) {
  TersoffTerm<double> term = tersoff_set("si_multiscale").terms[0];
  term.R = 2.5, term.D = 0.3;
  Mat3 gradient;
  gradient << 0.3, -0.2, 0.5, 0.1, -0.4, 0.2, 0.6, 0.2, 0.1;
  for (const int m : {1, 3}) {
    term.m = m;
    BondPath path = diamond_path(5.43, gradient, Vec3(0.3, -0.5, 0.4));
    for (size_t j = 0; j < 4; ++j) path.at[j] += 0.05 * path.rate[j];
    const PathEnergy<double> is = path_energy(term, path);
    constexpr double h = 1e-4;
    const double up = energy_at(term, path, h), here = energy_at(term, path, 0),
                 down = energy_at(term, path, -h);
    EXPECT_EQ(is.energy, here);
    EXPECT_NEAR(is.slope, (up - down) / (2 * h), 1e-5 * std::abs(is.slope)) << m;
    EXPECT_NEAR(is.curvature, (up - 2 * here + down) / (h * h), 1e-4 * std::abs(is.curvature)) << m;
  }
}

// Of each property by each parameter. A relative step of 1e-6 leaves 1e-12 of the third derivatives, and
// 1e-16/1e-6 of the sums that a property is the difference of.
TEST(DiamondProperties, SlopesByParametersAreThoseOfDifferences) {
  TersoffTerm<double> term = tersoff_set("si_multiscale").terms[0];
  term.R = 2.5, term.D = 0.3;
  size_t moved = 0;
  for (const int m : {1, 3}) {
    term.m = m;
    const DiamondProperties is = diamond_properties(term, 5.5, true);
    EXPECT_EQ(is.value, diamond_properties(term, 5.5, false).value);
    for (size_t k = 0; k < kTersoffFree; ++k) {
      TersoffFree up = free_of(term), down = up;
      const double h = 1e-6 * std::abs(up[k]);
      up[k] += h, down[k] -= h;
      const DiamondProperties above = diamond_properties(with_free(term, up), 5.5, false),
                              below = diamond_properties(with_free(term, down), 5.5, false);
      for (size_t p = 0; p < kDiamondProperties; ++p) {
        const double slope = (above.value[p] - below.value[p]) / (2 * h);
        // Along with the largest change that a parameter makes: some change nothing.
        const double scale = std::abs(is.slopes[p][k]) + 1e-3 * std::abs(is.value[p] / up[k]);
        EXPECT_NEAR(is.slopes[p][k], slope, 1e-6 * scale) << m << " " << kTersoffFreeNames[k] << " " << p;
        moved += is.slopes[p][k] != 0;
      }
    }
  }
  EXPECT_GT(moved, 150U);  // of 176
}

TEST(DiamondProperties, ParametersGoOutAndIn) {
  const TersoffTerm<double> term = tersoff_set("si_1988").terms[0];
  const TersoffFree free = free_of(term);
  EXPECT_EQ(free[0], term.A);
  EXPECT_EQ(free[4], term.lambda3);
  EXPECT_EQ(free[10], term.cos_theta0);
  EXPECT_EQ(free_of(with_free({}, free)), free);
}

}  // namespace
}  // namespace cuboct
