// SPDX-License-Identifier: MIT
// Elastic constants that are second derivatives of the energy, as fits of potentials have them, beside
// LAMMPS's stress of strained cells under the same parameters.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/diamond_properties.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

constexpr double kStrain = 1e-4;

// LAMMPS's stress, eV/angstrom^3, of the cell under a strain; `rest`: atoms where they rest in it.
Mat3 lammps_stress(const Tersoff& tersoff, const std::string& pair, AtomCell cell, const Mat3& strain,
                   bool rest) {
  cell = strained(cell, strain);
  if (rest) {
    TersoffForces forces(tersoff);
    rest_within(forces, cell, 1e-10);
  }
  return test::lammps_forces({.box = cell.box, .x = cell.x, .element = {}, .pair = pair}).virial /
         cell.box.volume();
}

// d(stress)/d(strain ab), by central differences. Strains of edges that stay upper triangular, as LAMMPS has
// them: a shear is one component, of engineering strain.
Mat3 slope(const Tersoff& tersoff, const std::string& pair, const AtomCell& cell, int a, int b, bool rest) {
  Mat3 strain = Mat3::Zero();
  strain(a, b) = kStrain;
  return (lammps_stress(tersoff, pair, cell, strain, rest) -
          lammps_stress(tersoff, pair, cell, -strain, rest)) /
         (2 * kStrain);
}

// A fit may claim half a per cent. The error of these differences is far below: the square of the strain,
// times some ten.
void compare(const Tersoff& tersoff, const std::string& file, double guess) {
  const std::string pair = fmt::format("pair_style tersoff\npair_coeff * * {} Si", file);
  TersoffForces forces(tersoff);
  const double edge = 2 * at_no_pressure(forces, diamond_cell(guess)).box.edges(0, 1);
  const AtomCell cell = diamond_block(edge, 2, 2, 2);
  const DiamondProperties is = diamond_properties(tersoff.terms[0], edge, false);
  const auto near = [](double value, double lammps, const char* name) {
    EXPECT_NEAR(value, lammps, 1e-5 * std::abs(lammps)) << name;
  };
  const Mat3 drawn = slope(tersoff, pair, cell, 0, 0, false);
  near(is.value[c11], drawn(0, 0), "C11");
  near(is.value[c12], drawn(1, 1), "C12");
  near(is.value[c44_clamped], slope(tersoff, pair, cell, 1, 2, false)(1, 2), "C44 clamped");
  near(is.value[c44], slope(tersoff, pair, cell, 1, 2, true)(1, 2), "C44");
  const test::LammpsForces rest =
      test::lammps_forces({.box = cell.box, .x = cell.x, .element = {}, .pair = pair});
  EXPECT_NEAR(is.value[cohesive], rest.energy / static_cast<double>(cell.x.size()), 1e-9);
  EXPECT_NEAR(is.value[edge_slope], 0, 1e-9);
  EXPECT_LT(rest.virial.norm() / cell.box.volume(), 1e-8);
}

TEST(TersoffConstantsPeer, OfFittedAndPublishedSiliconAreThoseOfLammps) {
  if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS (lmp) was not found when the build was configured";
  const std::string fitted = CUBOCT_SOURCE_DIR "/scenes/studies/silicon.tersoff";
  compare(read_tersoff(fitted, {"Si"}), fitted, 5.43);
  const std::string potentials = CUBOCT_POTENTIALS;
  if (potentials.empty()) return;
  const std::string published = potentials + "/SiC_Erhart-Albe.tersoff";
  compare(read_tersoff(published, {"Si"}), published, 5.43);
}

}  // namespace
}  // namespace cuboct
