// SPDX-License-Identifier: MIT
// Forces beside LAMMPS's peri/lps (Debian's lmp), in SI units. Without LAMMPS the test is skipped, and says
// so.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/rules/lps_body.h"
#include "tests/support/folder.h"

namespace cuboct {
namespace {

constexpr double kSpacing = 5e-4, kBulk = 14.9e9, kShear = 8.94e9, kVolume = 1.25e-10;
constexpr double kHorizon = 3 * kSpacing * (1 + 1e-9);  // the third neighbour is inside, whatever is rounded

// A free block, and places a little off those as packed. Bonds are made in the first run; LAMMPS breaks some
// of them when it is set up a third time, so that the second run is the one to look at.
std::string input_of(const Body& body, const std::vector<Vec3>& x) {
  std::string text = fmt::format(
      "units si\nboundary s s s\natom_style peri\natom_modify map array\nneighbor 0.0002 bin\n"
      "lattice sc {0}\nregion b block -1 9 -1 9 -1 9 units lattice\ncreate_box 1 b\n",
      kSpacing);
  for (const Vec3& at : body.x)
    text += fmt::format("create_atoms 1 single {:.17g} {:.17g} {:.17g} units box\n", at[0], at[1], at[2]);
  text += fmt::format(
      "set group all density 2200\nset group all volume {}\npair_style peri/lps\n"
      "pair_coeff * * {} {} {:.17g} 1e9 0.0\nfix 1 all nve\ntimestep 1e-9\nrun 0\n",
      kVolume, kBulk, kShear, kHorizon);
  for (size_t i = 0; i < x.size(); ++i)
    text += fmt::format("set atom {} x {:.17g} y {:.17g} z {:.17g}\n", i + 1, x[i][0], x[i][1], x[i][2]);
  return text + "dump d all custom 1 out.dump id fx fy fz\ndump_modify d format float %.17g sort id\nrun 0\n";
}

// N/m^3, by particle.
std::vector<Vec3> lammps_forces(const std::string& input, size_t particles) {
  const test::Folder folder;
  folder.write("in.lmp", input);
  const std::string command =
      fmt::format("cd '{}' && '{}' -in in.lmp -log none > out.txt 2>&1", folder.path().string(), CUBOCT_LMP);
  std::vector<Vec3> force(particles, Vec3::Zero());
  size_t read = 0;
  if (std::system(command.c_str()) == 0) {
    std::ifstream dump(folder.path("out.dump"));
    for (std::string line; std::getline(dump, line);) {
      std::istringstream words(line);
      size_t id = 0;
      Vec3 f;
      if (words >> id >> f[0] >> f[1] >> f[2] && id >= 1 && id <= particles) force[id - 1] = f, ++read;
    }
  }
  EXPECT_EQ(read, particles) << "LAMMPS gave no forces";
  return force;
}

// Both codes round in doubles, in other orders: 1e-12 of the largest force.
TEST(LpsLammps, ForcesOfAFreeBlockAreTheSame) {
  if (std::string(CUBOCT_LMP).empty()) GTEST_SKIP() << "no LAMMPS (lmp)";
  Body body = test::cubic_block(7, 6, 6);
  for (Vec3& at : body.x) at *= kSpacing;
  std::mt19937 dice(5);
  std::normal_distribution<double> noise(0, 0.002 * kSpacing);
  std::vector<Vec3> x = body.x;
  for (Vec3& at : x) at += Vec3(noise(dice), noise(dice), noise(dice));

  LpsMaterial m;
  m.mu = kShear, m.lambda = kBulk - 2 * kShear / 3;
  m.horizon = kHorizon, m.influence = 1, m.volume = kVolume, m.spacing = kSpacing;
  m.quadrature = LpsQuadrature::partial;
  test::LpsBody lps(m, simple_cubic_bonds(kSpacing, kHorizon), body);
  const std::vector<Vec3> f = lps.forces(x), expected = lammps_forces(input_of(body, x), x.size());
  double largest = 0, difference = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    largest = std::max(largest, expected[i].norm());
    difference = std::max(difference, (f[i] / kVolume - expected[i]).norm());
  }
  EXPECT_GT(largest, 1e9);
  EXPECT_LT(difference, 1e-12 * largest);
}

}  // namespace
}  // namespace cuboct
