// SPDX-License-Identifier: MIT
// Embedded atoms as a rule of text beside LAMMPS, with the files that come with it: energies, forces and
// runs.
//
// Both have the same tables in doubles. They differ by rounding, and LAMMPS's time has units of its own.
#include <gtest/gtest.h>

#include "model/base/mat3.h"
#include "tests/peer/lammps.h"
#include "tests/rules/metal.h"

namespace cuboct {
namespace {

using test::kAngstrom;
using test::kEv;

const std::string kMetalFiles = CUBOCT_POTENTIALS;

struct Metal {
  Scene scene;
  test::Crystal crystal;
  std::string style, coefficients;  // LAMMPS's
  int elements = 1;
};

Metal metal(const std::string& file, const std::string& style, double a, int cells) {
  Metal of{test::metal_scene(fmt::format("file = \"{}/{}\"", kMetalFiles, file), a, cells), {}, style, file};
  of.crystal = test::fcc_crystal(a, cells, false);
  return of;
}

// A third of the atoms, one by one, are tantalum.
Metal copper_tantalum() {
  const double a = 3.8;
  Metal of{parse_scene(fmt::format("packing = {{ pitch = \"{:.12g} angstrom\" }}\nbox = {{ periodic = "
                                   "\"xyz\", cells = [4, 4, 4] }}\n"
                                   "run = {{ dt = \"1 fs\", steps = 1 }}\nmaterial = [ {{ name = \"copper\", "
                                   "mass = \"63.546 u\" }}, {{ name = "
                                   "\"tantalum\", mass = \"180.95 u\", region = {{ shape = \"half_space\", "
                                   "point = \"[7, 0, 0] angstrom\", normal = "
                                   "\"x\" }} }} ]\n"
                                   "rule = {{ file = \"texts/eam_alloy.toml\", potential = {{ file = "
                                   "\"{}/CuTa.eam.alloy\", elements = {{ "
                                   "tantalum = \"Ta\", copper = \"Cu\" }} }} }}\n",
                                   a / std::sqrt(2.0), kMetalFiles),
                       CUBOCT_SOURCE_DIR "/scenes/rules/test.toml"),
           {},
           "eam/alloy",
           "CuTa.eam.alloy",
           2};
  of.crystal = test::fcc_crystal(a, 4, false);
  for (size_t i = 0; i < of.crystal.body.size(); ++i) of.crystal.body.type[i] = i % 3 == 1;
  EXPECT_EQ(of.scene.rule.types.at(0).name, "copper");
  EXPECT_EQ(of.scene.rule.types.at(1).name, "tantalum");
  return of;
}

test::LammpsForces beside(const Metal& of, int steps = 0, double dt = 0.001) {
  test::LammpsAtoms atoms;
  atoms.box = {diagonal(of.crystal.periodic.extent / kAngstrom), {true, true, true}};
  for (const Vec3& x : of.crystal.body.x) atoms.x.push_back(x / kAngstrom);
  atoms.element = of.crystal.body.type;
  atoms.elements = of.elements;
  atoms.pair = fmt::format("pair_style {}\npair_coeff * * {}/{}{}", of.style, kMetalFiles, of.coefficients,
                           of.elements == 2    ? " Cu Ta"
                           : of.style == "eam" ? ""
                                               : " Cu");
  atoms.mass = 63.546;
  if (steps > 0) atoms.moves = "fix moves all nve";
  atoms.steps = steps, atoms.dt = dt;
  return test::lammps_forces(atoms);
}

void compare(Metal of) {
  if (std::string(CUBOCT_LMP).empty()) GTEST_SKIP() << "no LAMMPS (lmp)";
  test::shake(of.crystal.body, 0.25, 5);
  const test::LammpsForces expected = beside(of);
  const auto engine = make_rounds_engine(of.scene.rule, of.crystal.body, of.crystal.periodic, {});
  const std::vector<Vec3> f = engine->forces();
  double largest = 0, worst = 0;
  for (size_t i = 0; i < f.size(); ++i) {
    largest = std::max(largest, expected.f[i].norm());
    worst = std::max(worst, (f[i] / kEv * kAngstrom - expected.f[i]).norm());
  }
  EXPECT_GT(largest, 0.5);
  EXPECT_LT(worst, 1e-9 * largest);
  EXPECT_NEAR(engine->terms()->energy() / kEv, expected.energy, 1e-10 * std::abs(expected.energy));
}

bool no_files() { return kMetalFiles.empty(); }

TEST(EmbeddedAtomsBesideLammps, Funcfl) {
  if (no_files()) GTEST_SKIP() << "no potential files of LAMMPS";
  compare(metal("Cu_u3.eam", "eam", 3.615, 4));
}

TEST(EmbeddedAtomsBesideLammps, Setfl) {
  if (no_files()) GTEST_SKIP() << "no potential files of LAMMPS";
  compare(metal("Cu_mishin1.eam.alloy", "eam/alloy", 3.615, 4));
}

TEST(EmbeddedAtomsBesideLammps, AnAlloy) {
  if (no_files()) GTEST_SKIP() << "no potential files of LAMMPS";
  compare(copper_tantalum());
}

// 0.2 ps from a crystal that was shaken: the same places, as long as chaos leaves digits.
TEST(EmbeddedAtomsBesideLammps, ARun) {
  if (no_files() || std::string(CUBOCT_LMP).empty()) GTEST_SKIP() << "no LAMMPS, or none of its files";
  Metal of = metal("Cu_u3.eam", "eam", 3.615, 4);
  test::shake(of.crystal.body, 0.2, 6);
  constexpr int kSteps = 100;
  of.scene.rule.dt = 2e-15;
  // LAMMPS takes the mass of the file, 63.55.
  of.scene.rule.mass = 63.55 * test::kLammpsMass * kEv * 1e-24 / (kAngstrom * kAngstrom);
  const auto engine = make_rounds_engine(of.scene.rule, of.crystal.body, of.crystal.periodic,
                                         {.integrator = Integrator::velocity_verlet});
  for (int step = 1; step <= kSteps; ++step) engine->step(static_cast<uint64_t>(step));
  const test::LammpsForces expected = beside(of, kSteps, 0.002);
  Body here = of.crystal.body;
  engine->read(here);
  double worst = 0, moved = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    worst = std::max(worst, (here.x[i] / kAngstrom - expected.x[i]).norm());
    moved = std::max(moved, (here.x[i] - of.crystal.body.x[i]).norm() / kAngstrom);
  }
  EXPECT_GT(moved, 0.2);
  EXPECT_LT(worst, 1e-6);
}

}  // namespace
}  // namespace cuboct
