// SPDX-License-Identifier: MIT
// Elastic constants of rules that are text: beside lattice sums, closed forms and what the rule's tables were
// fitted to.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "model/analysis/scene_cell.h"
#include "model/analysis/strained_cell.h"
#include "model/base/error.h"
#include "model/base/mat3.h"
#include "model/contract/law.h"
#include "model/scene/rule_cell.h"
#include "model/scene/scene.h"
#include "tests/fcc_block.h"
#include "tests/fcc_cell.h"

namespace cuboct {
namespace {

constexpr double kCellStrain = 1e-6;

Scene matter_of(const std::string& rule, const std::string& pitch = "\"1 mm\"",
                const std::string& more = "") {
  return parse_scene(more + "density = \"2440 kg/m^3\"\npacking = { pitch = " + pitch +
                         " }\ngeometry = { shape = \"sphere\", radius = \"3 mm\" }\n"
                         "run = { dt = \"1 ns\", steps = 1 }\n" +
                         rule,
                     CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
}

ElasticTensor constants_of(const Rule& rule, const CrystalCell& cell) {
  uint64_t evaluations = 0;
  const ElasticTensor tensor = tensor_of(rule, cell, kCellStrain, 1, evaluations);
  EXPECT_GT(evaluations, 0U);
  return tensor;
}

double apart(const Matrix6& a, const Matrix6& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

// A pair law that is text has the sums of the law, also under stress.
TEST(TextCell, OfAPairLawAreTheLatticeSums) {
  const Scene scene = parse_scene(
      "units = \"reduced\"\nmass = 1.0\npacking = { pitch = 1.08 }\ngeometry = { shape = \"sphere\", radius "
      "= 3 }\n"
      "run = { dt = 0.001, steps = 1 }\n[rule]\nreach = 2.6\nstiffness = 300\n[[rule.round]]\n"
      "sum.force = \"24 * (r^-6 - 2 * r^-12) / r^2 * d\"\n",
      "pair");
  const Rule law = test::simple_rule(lennard_jones(1, 1, 2.6, 0.8), 1, 1);
  const CrystalCell cell = cell_of(scene, "").cell;
  const ElasticTensor found = constants_of(scene.rule, cell), expected = elastic_tensor(law, cell);
  EXPECT_LT(apart(found.c, expected.c), 1e-7);
  EXPECT_LT((found.stress - expected.stress).norm(), 1e-10 * expected.c(0, 0));
  EXPECT_GT(expected.stress.norm(), 1e-3 * expected.c(0, 0));
}

// FCC with 18 neighbours and weights r^-4 is isotropic, of any Poisson's ratio
// (docs/reference/peridynamics.md).
TEST(TextCell, OfGlassAreThoseOfAnIsotropicBody) {
  for (const double ratio : {-0.2, 0.22, 0.4}) {
    const Scene scene = matter_of(
        fmt::format("[rule]\nfile = \"texts/glass.toml\"\nparameters = {{ youngs_modulus = \"72 GPa\", "
                    "poissons_ratio = {} }}\n",
                    ratio));
    const double bulk = 72e9 / (3 * (1 - 2 * ratio)), shear = 72e9 / (2 * (1 + ratio));
    Matrix6 expected = Matrix6::Zero();
    expected.topLeftCorner<3, 3>().setConstant(bulk - 2 * shear / 3);
    for (int k = 0; k < 6; ++k) expected(k, k) += k < 3 ? 2 * shear : shear;
    const CrystalCell cell = cell_of(scene, "").cell;
    EXPECT_LT(apart(constants_of(scene.rule, cell).c, expected), 1e-7) << ratio;
    // Bonds remember the packing: a cell that is wider by a part of 1e-5 is under stress.
    StrainedCell wide(scene.rule, cell);
    wide.deform((1 + 1e-5) * Mat3::Identity());
    const ElasticTensor under = constants_of(scene.rule, wide.cell());
    EXPECT_NEAR(under.stress.trace() / 3 / (3e-5 * bulk), 1, 1e-4) << ratio;
  }
}

// eV per atom of the closed form of scenes/rules/texts/copper.py, its FCC crystal strained by `e`.
double copper_energy(const Mat3& e) {
  constexpr double kEnd[] = {1.2247449, 1.1547054, 1.1180065, 1.0, 0.8660254, 0.7071068};
  constexpr double kPair[] = {29.059214, -140.05681, 130.07331, -17.48135, 31.82546, 71.58749};
  double pair = 0, density = 0;
  for (int x = -4; x <= 4; ++x)
    for (int y = -4; y <= 4; ++y)
      for (int z = -4; z <= 4; ++z) {
        if ((x + y + z) % 2 != 0 || (x == 0 && y == 0 && z == 0)) continue;
        const double r = ((Mat3::Identity() + e) * Vec3(x, y, z)).norm() / 2;
        for (int k = 0; k < 6; ++k) pair += kPair[k] * std::pow(std::max(kEnd[k] - r, 0.0), 3);
        density += 9.806694 * std::pow(std::max(kEnd[0] - r, 0.0), 3) +
                   16.774638 * std::pow(std::max(1.0 - r, 0.0), 3);
      }
  return pair / 2 - std::sqrt(density);
}

// A second round reads what the first made of a neighbour, so images reach twice as far. Beside second
// differences of the closed form's energy: cubics of it end at each shell of neighbours, where between points
// of the table the curvature is off by a point's distance, 0.0015 a, times the jump of the third slope: 2 %.
TEST(TextCell, OfCopperAreTheSlopesOfItsEnergy) {
  const Scene scene = parse_scene(
      "mass = \"63.546 u\"\npacking = { pitch = \"2.556191 angstrom\" }\n"
      "geometry = { shape = \"sphere\", radius = \"1 nm\" }\nrun = { dt = \"1 fs\", steps = 1 }\n"
      "[rule]\nfile = \"texts/eam.toml\"\npotential.file = \"texts/copper.eam.alloy\"\n",
      CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
  const CrystalCell one = cell_of(scene, "").cell;
  const ElasticTensor found = constants_of(scene.rule, one);
  constexpr double kStep = 1e-4;
  const double pascal = 1.602176634e-19 / (std::pow(3.615e-10, 3) / 4);
  const auto curvature = [&](const Mat3& e) {
    return (copper_energy(kStep * e) + copper_energy(-kStep * e) - 2 * copper_energy(Mat3::Zero())) * pascal /
           (kStep * kStep);
  };
  const Mat3 pull = diagonal({1, 0, 0}), both = diagonal({1, 1, 0});
  Mat3 shear = Mat3::Zero();
  shear(1, 2) = shear(2, 1) = 0.5;
  const double c11 = curvature(pull), c12 = curvature(both) / 2 - c11, c44 = curvature(shear);
  EXPECT_NEAR(found.c(0, 0) / c11, 1, 0.03);
  EXPECT_NEAR(found.c(0, 1) / c12, 1, 0.03);
  EXPECT_NEAR(found.c(3, 3) / c44, 1, 0.03);
  EXPECT_LT(apart(found.c.transpose(), found.c), 1e-6);
  // Four atoms of a cubic cell are the same matter.
  const double pitch = one.vectors.col(0).norm();
  const Body body = test::fcc_block(1, pitch);
  CrystalCell cubic;
  cubic.vectors = diagonal(test::fcc_box(1, pitch).extent);
  cubic.x = body.x, cubic.type = body.type;
  EXPECT_LT(apart(constants_of(scene.rule, cubic).c, found.c), 1e-6);
}

// LAMMPS's own, GPa, of files that come with it: strained by 1e-4 at rest.
TEST(TextCell, OfPotentialFilesAreThoseOfLammps) {
  const std::string directory = CUBOCT_POTENTIALS;
  if (directory.empty()) GTEST_SKIP() << "no potential files of LAMMPS";
  for (const auto& [name, c11, c12, c44] :
       {std::tuple{"Cu_u3.eam", 167.26, 124.15, 76.45}, {"Cu_mishin1.eam.alloy", 169.88, 122.58, 76.21}}) {
    const Scene scene = parse_scene(
        fmt::format(
            "mass = \"63.546 u\"\npacking = {{ pitch = \"2.556191 angstrom\" }}\n"
            "geometry = {{ shape = \"sphere\", radius = \"1 nm\" }}\nrun = {{ dt = \"1 fs\", steps = 1 }}\n"
            "[rule]\nfile = \"texts/eam.toml\"\npotential.file = \"{}/{}\"\n",
            directory, name),
        CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
    const Matrix6 c =
        constants_of(scene.rule, without_stress(scene.rule, cell_of(scene, "").cell, 1)).c / 1e9;
    EXPECT_NEAR(c(0, 0), c11, 1e-3 * c11) << name;
    EXPECT_NEAR(c(0, 1), c12, 1e-3 * c11) << name;
    EXPECT_NEAR(c(3, 3), c44, 1e-3 * c11) << name;
  }
}

void expect_no_cell(const Scene& scene, const std::string& why) {
  try {
    refuse_cell(scene.rule);
    ADD_FAILURE() << "not refused: " << why;
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, why.size()), why);
  }
}

TEST(TextCell, SaysWhatHasNone) {
  const std::string glass = "[rule]\nfile = \"texts/glass.toml\"\n";
  expect_no_cell(matter_of("[rule]\nfile = \"texts/heat.toml\"\n"),
                 "a cell at rest leaves out time, and the rule moves no particle");
  expect_no_cell(matter_of("[rule]\nreach = \"1.2 * pitch\"\n[[rule.round]]\nsum.force = \"1 N/m * d\"\n"),
                 "a cell at rest leaves out time, and the rule does not say its stiffness");
  expect_no_cell(matter_of(glass + "start.whole = \"x_i.x < 1 mm\"\n"),
                 "the start of 'whole' asks where it is, and a cell of the matter is anywhere");
  expect_no_cell(matter_of(glass + "start.hard = \"noise(1) < 0\"\n"),
                 "the start of 'hard' asks where it is, and a cell of the matter is anywhere");
  expect_no_cell(
      matter_of(glass + "start.hard = \"inside_j(all)\"\n[regions]\nall = { shape = \"half_space\", point "
                        "= \"[9, 0, 0] m\", normal = \"x\" }\n"),
      "the start of 'hard' asks where it is, and a cell of the matter is anywhere");
  refuse_cell(matter_of(glass).rule);
  EXPECT_EQ(starts_by_place(matter_of(glass + "start.whole = \"x_i.x < 1 mm\"\n").rule),
            std::vector<std::string>{"whole"});
}

}  // namespace
}  // namespace cuboct
