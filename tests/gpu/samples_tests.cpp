// SPDX-License-Identifier: MIT
// Samples in blocks' memory, compiled for the host, beside the potential in doubles that
// tests/peer/tersoff_test.cpp compares with LAMMPS.
#include "emu/gpu/samples/samples.h"

#include <gtest/gtest.h>

#include <random>

#include "model/base/error.h"

namespace cuboct::gpu {
namespace {

constexpr int kAxes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};

std::vector<AtomCell> shaken_samples(int cubes, int count, double shake, double shear = 0.03) {
  std::vector<AtomCell> samples;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (int s = 0; s < count; ++s) {
    Mat3 strain;
    for (double& component : strain.reshaped()) component = shear / 3 * normal(random);
    AtomCell& sample = samples.emplace_back(strained(diamond_block(5.43, cubes, cubes, cubes), strain));
    for (Vec3& x : sample.x) x += shake * Vec3(normal(random), normal(random), normal(random));
  }
  return samples;
}

struct Largest {
  double energy = 0, force = 0, virial = 0;  // differences over the largest value
};

Largest differences(const Samples& samples, const std::vector<AtomCell>& cells, const Tersoff& tersoff) {
  const std::vector<Vec3> x = samples.positions(), f = samples.forces();
  const std::vector<SampleState> states = samples.states();
  TersoffForces exact(tersoff);
  const size_t atoms = cells.front().x.size();
  Largest largest;
  for (size_t s = 0; s < cells.size(); ++s) {
    const std::span<const Vec3> at(x.data() + s * atoms, atoms);
    std::vector<Vec3> beside(atoms);
    BondList list(tersoff.cutoff(), 0.3, bond_lanes());
    list.update(cells[s].box, at);
    exact.evaluate(list, cells[s].box, at, beside, {.sums = true});
    double most = 0, off = 0;
    for (size_t i = 0; i < atoms; ++i) {
      most = std::max(most, beside[i].cwiseAbs().maxCoeff());
      off = std::max(off, (beside[i] - f[s * atoms + i]).cwiseAbs().maxCoeff());
    }
    largest.force = std::max(largest.force, off / most);
    largest.energy = std::max(largest.energy, std::abs(states[s].energy / exact.energy() - 1));
    for (size_t k = 0; k < 6; ++k)
      largest.virial =
          std::max(largest.virial, std::abs(states[s].virial[k] - exact.virial()(kAxes[k][0], kAxes[k][1])) /
                                       exact.virial().cwiseAbs().maxCoeff());
  }
  return largest;
}

class SamplesOfSet : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Sets, SamplesOfSet,
                         testing::Values("si_1988", "si_1989", "si_erhart_albe", "si_multiscale"),
                         [](const auto& info) { return std::string(info.param); });

// Atoms are shaken by 0.3 angstrom, so that many bonds lie where fc falls. Sums of some hundred terms of up
// to 1e3 of the result keep 1e-11.
TEST_P(SamplesOfSet, DoublesAreThoseOfThePotential) {
  const Tersoff tersoff = tersoff_set(GetParam());
  const std::vector<AtomCell> cells = shaken_samples(2, 3, 0.3);
  const auto samples = make_samples(tersoff.term(0, 0, 0), {.doubles = true});
  samples->set(cells);
  samples->evaluate();
  const Largest off = differences(*samples, cells, tersoff);
  EXPECT_LT(off.energy, 1e-12);
  EXPECT_LT(off.force, 1e-11);
  EXPECT_LT(off.virial, 1e-11);
}

// A position of 10 angstrom is rounded by 5e-7; a bond's stiffness of 20 eV/angstrom^2 makes that 1e-5 of
// forces of some eV/angstrom. The energy's two parts, each up to twice its size, change by 2.5 of that
// rounding. A hundredfold of either would be seen.
TEST_P(SamplesOfSet, FloatsAreNear) {
  const Tersoff tersoff = tersoff_set(GetParam());
  const std::vector<AtomCell> cells = shaken_samples(2, 3, 0.1);
  const auto samples = make_samples(tersoff.term(0, 0, 0));
  samples->set(cells);
  samples->evaluate();
  const Largest off = differences(*samples, cells, tersoff);
  EXPECT_LT(off.energy, 5e-6);
  EXPECT_LT(off.force, 3e-5);
  EXPECT_LT(off.virial, 3e-5);
}

// A cell of one cube is thinner than two cutoffs: an atom has several images of one neighbour.
TEST(Samples, OneCubeIsTheBlockOfEight) {
  const Tersoff tersoff = tersoff_set("si_erhart_albe");
  double per_atom[2] = {};
  for (const int cubes : {1, 2}) {
    std::vector<AtomCell> cells{strained(diamond_block(5.43, cubes, cubes, cubes), 0.02 * Mat3::Ones())};
    const auto samples = make_samples(tersoff.term(0, 0, 0), {.doubles = true});
    samples->set(cells);
    samples->relax(1e-8, 25, 1000);
    EXPECT_LT(samples->states().front().force, 1e-8);
    per_atom[cubes - 1] = samples->states().front().energy / static_cast<double>(cells.front().x.size());
  }
  EXPECT_NEAR(per_atom[0], per_atom[1], 1e-12);
}

// Relaxed samples are at rest for the potential in doubles, and their virial is the slope of the relaxed
// energy.
TEST(Samples, StressAtRestIsTheEnergysSlope) {
  const Tersoff tersoff = tersoff_set("si_multiscale");
  constexpr double kStep = 1e-4;
  Mat3 shear = Mat3::Zero();
  shear(1, 2) = shear(2, 1) = 1;
  std::vector<AtomCell> cells;
  for (const double by : {0.02 - kStep, 0.02, 0.02 + kStep})
    cells.push_back(strained(diamond_block(5.43, 2, 2, 2), by / 2 * shear));
  const auto samples = make_samples(tersoff.term(0, 0, 0), {.doubles = true});
  samples->set(cells);
  samples->relax(1e-7, 25, 5000);
  const std::vector<SampleState> states = samples->states();
  // virial is dE of the strain on top of the sheared cell; (1 + a)(1 + b) = 1 + a + b + ab of two such
  // strains, whose product is diagonal: the next order, by/2 of a direct stress.
  const double slope = (states[2].energy - states[0].energy) / (2 * kStep);
  const double mixed = 0.02 / 4 * (states[1].virial[1] + states[1].virial[2]);
  EXPECT_NEAR(states[1].virial[3], slope + mixed, 2e-3 * std::abs(slope));
  for (const SampleState& state : states) EXPECT_LT(state.force, 1e-7);
}

// Warm enough that atoms leave their lists' skin. The energy of velocity Verlet swings by (omega dt)^2/8 of a
// vibration's own, 3e-4 at 16 THz and 0.5 fs; a list that lacks a pair, or a force that is not its slope,
// would let it drift.
TEST(Samples, EnergyIsKeptWhileListsAreRenewed) {
  const Tersoff tersoff = tersoff_set("si_1989");
  const std::vector<AtomCell> cells = shaken_samples(2, 1, 0.2);
  const auto samples = make_samples(tersoff.term(0, 0, 0), {.doubles = true, .skin = 0.1});
  samples->set(cells);
  samples->evaluate();
  const double mass = 28.0855, before = samples->states().front().energy;
  double far = 0;
  for (int k = 0; k < 5; ++k) {
    samples->advance(100, 0.5, mass);
    double kinetic = 0;
    Vec3 momentum = Vec3::Zero();
    for (const Vec3& v : samples->velocities()) {
      kinetic += mass * kMassUnit / 2 * v.squaredNorm();
      momentum += v;
    }
    EXPECT_GT(kinetic, 1);
    EXPECT_NEAR(samples->states().front().energy + kinetic, before, 4e-3 * kinetic);
    EXPECT_LT(momentum.norm(), 1e-12);
  }
  for (size_t i = 0; i < 64; ++i) far = std::max(far, (samples->positions()[i] - cells[0].x[i]).norm());
  EXPECT_GT(far, 0.05);  // half the skin
  const Largest off = differences(*samples, cells, tersoff);
  EXPECT_LT(off.force, 1e-11);
}

TEST(Samples, RoomForBondsGrows) {
  const Tersoff tersoff = tersoff_set("si_1989");
  const std::vector<AtomCell> cells = shaken_samples(2, 2, 0.1);
  const auto little = make_samples(tersoff.term(0, 0, 0), {.doubles = true, .bonds_per_atom = 1});
  const auto enough = make_samples(tersoff.term(0, 0, 0), {.doubles = true, .bonds_per_atom = 8});
  for (Samples* samples : {little.get(), enough.get()}) {
    samples->set(cells);
    samples->advance(20, 1, 28.0855);
  }
  EXPECT_GT(little->block_bytes(), make_samples(tersoff.term(0, 0, 0))->block_bytes());
  EXPECT_EQ(little->positions(), enough->positions());
  EXPECT_EQ(little->states()[1].energy, enough->states()[1].energy);
}

TEST(Samples, RefusesWhatItCannotHold) {
  const Tersoff tersoff = tersoff_set("si_1989");
  std::vector<AtomCell> cells = shaken_samples(1, 2, 0);
  cells[1].box.edges.col(2) *= 0.5;
  const auto samples = make_samples(tersoff.term(0, 0, 0));
  try {
    samples->set(cells);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("sample 1: its cell is 2.7"), std::string::npos) << e.what();
  }
  const std::vector<AtomCell> large{diamond_block(5.43, 8, 8, 8)};
  EXPECT_THROW(samples->set(large), InputError);
  std::vector<AtomCell> same = shaken_samples(2, 2, 0);
  same[1].x[5] = same[1].x[6];
  samples->set(same);
  EXPECT_THROW(samples->evaluate(), std::runtime_error);
}

}  // namespace
}  // namespace cuboct::gpu
