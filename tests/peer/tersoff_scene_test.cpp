// SPDX-License-Identifier: MIT
// Scenes of atoms against LAMMPS, on the parameter files that come with it: the engine's energy and forces of
// crystals and sheets that are shaken, cut and open. The bound is that of tersoff_test.cpp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "model/rules/tersoff_rule.h"
#include "model/run/rounds_run.h"
#include "model/scene/scene.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

const std::string kPotentials = CUBOCT_POTENTIALS;

struct Case {
  const char* name;
  const char* file;
  const char* element;
  const char* place;  // where the atoms stand
};
void PrintTo(const Case& of, std::ostream* out) { *out << of.name; }
class TersoffScenePeer : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Scenes, TersoffScenePeer,
    testing::Values(
        Case{"TornSheet", "SiC.tersoff", "C",
             "[crystal]\nlattice = \"graphene\"\nzigzag = \"y\"\n[geometry]\nshape = \"difference\"\n"
             "from = { shape = \"box\", size = \"[28, 22, 1] angstrom\" }\n"
             "minus = [{ shape = \"box\", min = \"[-15, -2, -1] angstrom\", max = \"[0, 2, 1] "
             "angstrom\" }]\n"},
        Case{"Slab", "Si.tersoff", "Si",
             "[crystal]\nlattice = \"diamond\"\nedge = \"5.5 angstrom\"\n[box]\ncells = [4, 3, 3]\n"
             "periodic = \"xy\"\n"},
        Case{"Block", "SiC_Erhart-Albe.tersoff", "Si",
             "[crystal]\nlattice = \"diamond\"\n[box]\ncells = [3, 2, 3]\nperiodic = \"xyz\"\n"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(TersoffScenePeer, HasItsEnergyAndForces) {
  if (!test::have_lammps() || kPotentials.empty())
    GTEST_SKIP() << "LAMMPS or its potential files are not installed";
  const std::string file = kPotentials + "/" + GetParam().file;
  // Of 3000 K the velocities shake the atoms by some 0.2 angstrom in 20 fs.
  const Scene scene = parse_scene(
      fmt::format("mass = \"12.011 u\"\n{}[rule]\nkind = \"tersoff\"\nfile = \"{}\"\nelement = \"{}\"\n"
                  "[[velocity]]\ntemperature = \"3000 K\"\nseed = 5\n[run]\ndt = \"0.5 fs\"\nsteps = 40\n",
                  GetParam().place, file, GetParam().element),
      "scene");
  RoundsRun run(scene, scene.body, {}, 1e-9);
  run.advance(40, nullptr);
  const RealFrame frame = std::get<RealFrame>(run.frame(true));
  Asked asked;
  asked.energies = true;
  const double energy = run.read(asked).energies.potential / kElectronVolt;

  test::LammpsAtoms atoms{.box = {}, .x = {}, .element = {}};
  for (int a = 0; a < 3; ++a) {
    const double extent = scene.periodic.extent[a];
    atoms.box.periodic[static_cast<size_t>(a)] = extent > 0;
    atoms.box.edges(a, a) = extent > 0 ? extent / kAngstrom : 20;
  }
  double moved = 0;
  for (size_t i = 0; i < frame.x.size(); ++i) {
    atoms.x.push_back(frame.x[i] / kAngstrom);
    moved = std::max(moved, (frame.x[i] - scene.body.x[i]).norm() / kAngstrom);
  }
  ASSERT_GT(moved, 0.1);
  atoms.pair = fmt::format("pair_style tersoff\npair_coeff * * {} {}", file, GetParam().element);
  const test::LammpsForces expected = test::lammps_forces(atoms);
  EXPECT_NEAR(energy, expected.energy, 1e-9 * std::abs(expected.energy));
  double largest = 0, worst = 0;
  for (size_t i = 0; i < frame.x.size(); ++i) {
    largest = std::max(largest, expected.f[i].norm());
    worst = std::max(worst, (frame.force[i] * (kAngstrom / kElectronVolt) - expected.f[i]).norm());
  }
  ASSERT_GT(largest, 0.5);  // eV/angstrom
  EXPECT_LT(worst, 1e-9 * largest);
  RecordProperty("force_error", std::to_string(worst / largest * 1e15) + "e-15");
}

}  // namespace
}  // namespace cuboct
