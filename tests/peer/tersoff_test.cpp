// SPDX-License-Identifier: MIT
// Tersoff's potential against LAMMPS, on the parameter files that come with it: energies, forces and virials
// of random configurations with free surfaces, cracks and atoms within the fall of the cutoff.
//
// Both compute in doubles, so they differ by rounding alone. LAMMPS's g(theta) = 1 + c^2/d^2 - c^2/(d^2 +
// u^2) loses up to seven digits of its smallest values, with c^2/d^2 = 8e7 in carbon. The bound of 1e-9 of
// the largest force leaves room for that.
#include <gtest/gtest.h>

#include <random>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/atom_motion.h"
#include "tests/peer/lammps.h"

namespace cuboct {
namespace {

constexpr double kBound = 1e-9;
const std::string kPotentials = CUBOCT_POTENTIALS;

struct Atoms {
  AtomCell cell;
  std::vector<uint8_t> element;
};

void shake(AtomCell& cell, double most, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> move(-most, most);
  for (Vec3& x : cell.x) x += Vec3(move(random), move(random), move(random));
}

// Removes atoms within a slit of the given half height that reaches from x = 0 to `length`.
void cut_slit(AtomCell& cell, double length, double middle, double half) {
  std::erase_if(cell.x, [&](const Vec3& x) { return x[0] < length && std::abs(x[1] - middle) < half; });
}

// Bonds within the fall of the cutoff, R - D < r < R + D.
size_t falling(const Tersoff& tersoff, const AtomCell& cell) {
  const auto& t = tersoff.terms[0];
  size_t count = 0;
  for (const Vec3& a : cell.x)
    for (const Vec3& b : cell.x) {
      const double r = (a - b).norm();
      count += r > t.R - t.D && r < t.R + t.D;
    }
  return count;
}

void compare(const Tersoff& tersoff, const std::string& file, const AtomCell& cell,
             const std::vector<uint8_t>& element = {}) {
  std::string pair = "pair_style tersoff\npair_coeff * * " + kPotentials + "/" + file;
  for (const std::string& name : tersoff.elements) pair += " " + name;
  const test::LammpsForces expected =
      test::lammps_forces({.box = cell.box,
                           .x = cell.x,
                           .element = element,
                           .elements = static_cast<int>(tersoff.elements.size()),
                           .pair = pair});
  TersoffForces forces(tersoff);
  BondList list(tersoff.cutoff(), 0.3, bond_lanes());
  list.update(cell.box, cell.x);
  std::vector<Vec3> f(cell.x.size());
  forces.evaluate(list, cell.box, cell.x, f, {.sums = true, .element = element});
  double largest = 0, worst = 0;
  size_t where = 0;
  for (const Vec3& of : expected.f) largest = std::max(largest, of.norm());
  for (size_t i = 0; i < f.size(); ++i)
    if (const double off = (f[i] - expected.f[i]).norm(); off > worst) worst = off, where = i;
  ASSERT_GT(largest, 0.5);  // eV/angstrom: not at rest
  EXPECT_LT(worst, kBound * largest) << "atom " << where << " of " << f.size();
  EXPECT_NEAR(forces.energy(), expected.energy, kBound * std::abs(expected.energy));
  EXPECT_LT((forces.virial() - expected.virial).norm(), kBound * expected.virial.norm());
  testing::Test::RecordProperty("force_error", std::to_string(worst / largest * 1e15) + "e-15");
}

struct Case {
  const char* name;
  const char* file;
  const char* element;
  double a;  // of the diamond cube
};
void PrintTo(const Case& of, std::ostream* out) { *out << of.name; }

class TersoffPeer : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    if (!test::have_lammps()) GTEST_SKIP() << "LAMMPS is not installed";
    if (kPotentials.empty()) GTEST_SKIP() << "LAMMPS's potential files are not installed";
    tersoff_ = read_tersoff(kPotentials + "/" + GetParam().file, {GetParam().element});
  }
  Tersoff tersoff_;
};
INSTANTIATE_TEST_SUITE_P(Files, TersoffPeer,
                         testing::Values(Case{"Si_1988", "Si.tersoff", "Si", 5.431},
                                         Case{"Si_1989", "SiC.tersoff", "Si", 5.432},
                                         Case{"C_1989", "SiC.tersoff", "C", 3.566},
                                         Case{"Si_Erhart_Albe", "SiC_Erhart-Albe.tersoff", "Si", 5.429},
                                         Case{"Ge", "Ge.tersoff", "Ge", 5.658}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(TersoffPeer, ShakenAndSheared) {
  Mat3 strain = Mat3::Zero();
  strain(0, 1) = 0.1, strain(0, 2) = -0.07, strain(1, 2) = 0.05, strain(0, 0) = 0.03, strain(2, 2) = -0.02;
  const double bond = std::sqrt(3) / 4 * GetParam().a;
  for (const double most : {0.05, 0.2}) {
    AtomCell cell = strained(diamond_block(GetParam().a, 2, 2, 2), strain);
    shake(cell, most * bond, 5);
    compare(tersoff_, GetParam().file, cell);
  }
}

TEST_P(TersoffPeer, CrackedAndFree) {
  const double a = GetParam().a;
  for (const bool free : {false, true}) {
    Mat3 strain = Mat3::Zero();
    strain(1, 1) = 0.25;  // bonds across the slit reach into the fall of the cutoff
    AtomCell cell = strained(diamond_block(a, 4, 4, 2), strain);
    cut_slit(cell, 2 * a, 2.5 * a, 0.4 * a);
    cell.box.periodic = {false, !free, !free};
    shake(cell, 0.12 * a, 17);
    ASSERT_GT(falling(tersoff_, cell), 20u);
    compare(tersoff_, GetParam().file, cell);
  }
}

TEST(TersoffPeerSheet, TornGraphene) {
  if (!test::have_lammps() || kPotentials.empty())
    GTEST_SKIP() << "LAMMPS or its potential files are not installed";
  const Tersoff carbon = read_tersoff(kPotentials + "/SiC.tersoff", {"C"});
  for (const double stretch : {0.0, 0.12, 0.3}) {
    Mat3 strain = Mat3::Zero();
    strain(1, 1) = stretch;
    AtomCell cell = strained(graphene_sheet(1.4606, 3.35, 12, 7), strain);
    cut_slit(cell, 10, 15 * (1 + stretch), 2.5);
    cell.box.periodic = {false, true, false};
    shake(cell, 0.1, 23);
    compare(carbon, "SiC.tersoff", cell);
  }
}

// A sheet with an edge crack, whose lower and upper edges are driven apart along y while all atoms bear a
// force along x. Rounding grows with time, here by some hundred in 200 steps.
TEST(TersoffPeerSheet, TornInTime) {
  if (!test::have_lammps() || kPotentials.empty())
    GTEST_SKIP() << "LAMMPS or its potential files are not installed";
  AtomCell cell = graphene_sheet(1.4606, 3.35, 12, 7);
  cut_slit(cell, 10, 15, 2.5);
  cell.box.periodic = {false, false, false};
  shake(cell, 0.05, 31);
  const size_t n = cell.x.size(), edge = 48;  // atoms of a row of rectangles, the first and the last
  const std::string moves = "group edges id 1:" + std::to_string(edge) + " " + std::to_string(n - edge + 1) +
                            ":" + std::to_string(n) + "\ngroup low id 1:" + std::to_string(edge) +
                            "\ngroup high subtract edges low\nvelocity low set NULL -12 NULL\n"
                            "velocity high set NULL 12 NULL\nfix push all addforce 0.05 0 0\n"
                            "fix hold edges setforce NULL 0 NULL\nfix nve all nve";
  test::LammpsAtoms atoms{.box = cell.box, .x = cell.x, .element = {}};
  atoms.pair = "pair_style tersoff\npair_coeff * * " + kPotentials + "/SiC.tersoff C";
  atoms.moves = moves, atoms.dt = 5e-4, atoms.steps = 200;
  const test::LammpsForces expected = test::lammps_forces(atoms);

  AtomLoads loads{std::vector<Vec3>(n, Vec3(0.05, 0, 0)), std::vector<std::array<bool, 3>>(n),
                  std::vector<Vec3>(n)};
  AtomSystem system{cell.box, cell.x, std::vector<Vec3>(n, Vec3::Zero()), {}, {12 * test::kLammpsMass}};
  for (size_t i = 0; i < n; ++i)
    if (i < edge || i >= n - edge) {
      loads.imposed[i][1] = true;
      system.v[i][1] = loads.velocity[i][1] = i < edge ? -12 : 12;
    }
  AtomMotion motion(read_tersoff(kPotentials + "/SiC.tersoff", {"C"}), system, {.dt = 5e-4});
  motion.load(loads);
  motion.step(200);
  double worst = 0, moved = 0;
  for (size_t i = 0; i < n; ++i) {
    worst = std::max(worst, (motion.atoms().x[i] - expected.x[i]).norm());
    moved = std::max(moved, (expected.x[i] - cell.x[i]).norm());
  }
  ASSERT_GT(moved, 1);  // angstrom
  EXPECT_LT(worst, 1e-9);
  RecordProperty("motion_error", std::to_string(worst * 1e12) + "e-12");
}

TEST(TersoffPeerSheet, SiliconCarbide) {
  if (!test::have_lammps() || kPotentials.empty())
    GTEST_SKIP() << "LAMMPS or its potential files are not installed";
  for (const char* file : {"SiC.tersoff", "SiC_Erhart-Albe.tersoff"}) {
    const Tersoff tersoff = read_tersoff(kPotentials + "/" + file, {"Si", "C"});
    AtomCell cell = diamond_block(4.36, 3, 2, 2);
    std::vector<uint8_t> element(cell.x.size());
    for (size_t i = 0; i < element.size(); ++i) element[i] = i % 2;
    element[6] = 0, element[13] = 1;  // antisites: bonds of one kind too
    cell.box.periodic[0] = false;
    shake(cell, 0.3, 29);
    compare(tersoff, file, cell, element);
  }
}

}  // namespace
}  // namespace cuboct
