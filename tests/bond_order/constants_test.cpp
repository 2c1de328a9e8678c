// SPDX-License-Identifier: MIT
// Constants of crystals under published sets, beside those that LAMMPS computed.
#include <gtest/gtest.h>

#include "model/atoms/bond_order/atom_cell.h"

namespace cuboct {
namespace {

// Computed by LAMMPS 29 Sep 2021 with its own files: E in eV per atom, a in angstrom, GPa. The bound is that
// of the printed digits, and where a constant is a small difference of large ones that of LAMMPS's own
// differences.
struct Known {
  const char* set;
  double energy, a, c11, c12, c44, c44_clamped;
};
void PrintTo(const Known& known, std::ostream* out) { *out << known.set; }
class TersoffConstants : public testing::TestWithParam<Known> {};
INSTANTIATE_TEST_SUITE_P(
    Sets, TersoffConstants,
    testing::Values(Known{"si_1988", -4.630412, 5.431231, 121.70, 85.81, 10.31, 92.34},
                    Known{"si_1989", -4.628873, 5.432115, 142.51, 75.36, 69.01, 118.79},
                    Known{"c_1989", -7.368190, 3.565835, 1073.61, 101.72, 641.27, 670.92},
                    Known{"si_erhart_albe", -4.628415, 5.428877, 169.34, 64.14, 60.41, 104.52}),
    [](const auto& info) { return std::string(info.param.set); });

TEST_P(TersoffConstants, OfDiamondAreThoseOfLammps) {
  const Known& known = GetParam();
  TersoffForces forces(tersoff_set(known.set));
  const AtomCell cell = at_no_pressure(forces, diamond_cell(known.a * 1.02));
  const CellConstants constants = constants_of(forces, cell);
  EXPECT_NEAR(2 * cell.box.edges(0, 1), known.a, 1e-6 * known.a);
  EXPECT_NEAR(constants.energy, known.energy, 1e-6);
  const auto near = [](double value, double other) {
    EXPECT_NEAR(value * kGpaOfEvPerA3, other, 0.002 * other);
  };
  near(constants.relaxed(0, 0), known.c11);
  near(constants.relaxed(0, 1), known.c12);
  near(constants.relaxed(3, 3), known.c44);
  near(constants.clamped(3, 3), known.c44_clamped);
  EXPECT_LT(constants.stress.norm(), 1e-12);
}

constexpr double kThickness = 3.35;  // angstrom

AtomCell resting_graphene(TersoffForces& forces) {
  return at_no_pressure(forces, graphene_sheet(1.44, kThickness, 1, 1));
}

TEST(TersoffGraphene, HasTheConstantsOfLammps) {
  TersoffForces forces(tersoff_set("c_1989"));
  const AtomCell cell = resting_graphene(forces);
  const CellConstants constants = constants_of(forces, cell);
  EXPECT_NEAR(cell.box.edges(1, 1) / 3, 1.460601, 1e-6);
  EXPECT_NEAR(constants.energy, -7.393187, 1e-6);
  // The thickness of the cell was scaled by nothing: it is no axis that repeats.
  const auto gpa = [&](int a, int b) { return constants.relaxed(a, b) * kGpaOfEvPerA3; };
  EXPECT_NEAR(gpa(0, 0), 1247.0, 0.002 * 1247);
  EXPECT_NEAR(gpa(1, 1), 1247.0, 0.002 * 1247);
  EXPECT_NEAR(gpa(0, 1), -197.1, 0.002 * 197);
  EXPECT_NEAR(gpa(5, 5), 722.1, 0.002 * 722);
}

// Pulled along `axis`, free across it: stress over the width that is left and the thickness.
std::vector<double> tension(int axis, const std::vector<double>& strains) {
  TersoffForces forces(tersoff_set("c_1989"));
  const AtomCell rest = resting_graphene(forces);
  std::vector<double> stresses;
  double across = 0;
  for (const double strain : strains) {
    const auto at = [&](double side) {
      Mat3 pulled = Mat3::Zero();
      pulled(axis, axis) = strain, pulled(1 - axis, 1 - axis) = side;
      AtomCell cell = strained(rest, pulled);
      rest_within(forces, cell, 1e-9);
      return stress_of(forces, cell);
    };
    double low = across - 0.1, high = across + 0.1;
    while (high - low > 1e-9) {
      const double middle = (low + high) / 2;
      (at(middle)(1 - axis, 1 - axis) < 0 ? low : high) = middle;
    }
    across = low;
    stresses.push_back(at(across)(axis, axis) * kGpaOfEvPerA3);
  }
  return stresses;
}

TEST(TersoffGraphene, PullsAsInLammps) {
  const std::vector<double> strains = {0.019, 0.039, 0.059, 0.079, 0.099, 0.119, 0.139, 0.159};
  const std::vector<double> zigzag = {21.5, 40.8, 57.1, 70.6, 81.8, 90.8, 98.0, 103.6};
  const std::vector<double> armchair = {21.3, 40.1, 55.5, 67.9, 77.6, 84.8, 89.7, 92.6};
  const std::vector<double> along_x = tension(0, strains), along_y = tension(1, strains);
  for (size_t k = 0; k < strains.size(); ++k) {
    EXPECT_NEAR(along_x[k], zigzag[k], 0.005 * zigzag[k]) << strains[k];
    EXPECT_NEAR(along_y[k], armchair[k], 0.005 * armchair[k]) << strains[k];
  }
}

}  // namespace
}  // namespace cuboct
