// SPDX-License-Identifier: MIT
// Atoms in time: energy, momentum, driven and loaded atoms, rest. tests/peer compares trajectories with
// LAMMPS.
#include <gtest/gtest.h>

#include <random>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/atoms/bond_order/atom_motion.h"
#include "model/base/mat3.h"

namespace cuboct {
namespace {

constexpr double kMass = 12.011 * 1.036426966e-4;  // eV ps^2/angstrom^2
constexpr double kBond = 1.460601;                 // angstrom, graphene's at rest

AtomSystem sheet(int nx, int ny, std::array<bool, 3> periodic) {
  AtomCell cell = graphene_sheet(kBond, 3.35, nx, ny);
  cell.box.periodic = periodic;
  return {cell.box, cell.x, {}, {}, {kMass}};
}

AtomSystem warm_sheet(double speed, bool closed = false) {
  AtomSystem system = sheet(6, 4, {true, closed, false});
  std::mt19937_64 random(3);
  std::normal_distribution<double> draw(0, speed);
  Vec3 mean = Vec3::Zero();
  for (size_t i = 0; i < system.x.size(); ++i) {
    const double z = draw(random), y = draw(random), x = draw(random);
    system.v.emplace_back(x, y, z);
  }
  for (const Vec3& v : system.v) mean += v / static_cast<double>(system.v.size());
  for (Vec3& v : system.v) v -= mean;
  return system;
}

// Largest departure of the total energy from its start, over 0.2 ps.
double energy_error(double dt) {
  AtomMotion motion(tersoff_set("c_1989"), warm_sheet(5, true), {.dt = dt});
  const double start = motion.potential_energy() + motion.kinetic_energy();
  double error = 0;
  for (int k = 0; k < 20; ++k) {
    motion.step(static_cast<uint64_t>(std::lround(0.01 / dt)));
    error = std::max(error, std::abs(motion.potential_energy() + motion.kinetic_energy() - start));
  }
  return error;
}

// Verlet's energy errs by dt^2: four times less at half the step. In a closed sheet, no bond of which is in
// the fall of the cutoff, where the force has a kink.
TEST(AtomMotion, KeepsItsEnergyToTheSquareOfTheStep) {
  const double coarse = energy_error(5e-4), fine = energy_error(2.5e-4);
  EXPECT_LT(coarse, 0.05);  // eV, of some 4 eV in motion
  EXPECT_NEAR(coarse / fine, 4, 0.8);
}

TEST(AtomMotion, KeepsItsMomentumAndGoesBack) {
  const AtomSystem start = warm_sheet(5);
  AtomMotion motion(tersoff_set("c_1989"), start, {.dt = 5e-4});
  motion.step(200);
  EXPECT_LT(motion.momentum().norm(), 1e-13);
  AtomSystem back = motion.atoms();
  double moved = 0;
  for (size_t i = 0; i < back.x.size(); ++i) moved = std::max(moved, (back.x[i] - start.x[i]).norm());
  ASSERT_GT(moved, 0.1);
  for (Vec3& v : back.v) v = -v;
  AtomMotion again(tersoff_set("c_1989"), back, {.dt = 5e-4});
  again.step(200);
  for (size_t i = 0; i < back.x.size(); ++i)
    EXPECT_LT((again.atoms().x[i] - start.x[i]).norm(), 1e-9) << "atom " << i;
}

// Edges are pulled apart, the middle bears a body force: what is imposed moves so, and the rest obeys Newton.
TEST(AtomMotion, DrivesEdgesAndPushesAtoms) {
  AtomSystem system = sheet(4, 6, {true, false, false});
  const size_t n = system.x.size();
  AtomLoads loads{std::vector<Vec3>(n, Vec3(0.1, 0, 0)), std::vector<std::array<bool, 3>>(n),
                  std::vector<Vec3>(n)};
  for (size_t i = 0; i < n; ++i) {
    const bool low = system.x[i][1]<2, high = system.x[i][1]> 22;
    loads.velocity[i] = Vec3(0, high ? 3 : -3, 0);
    loads.imposed[i] = {false, low || high, false};
  }
  const std::vector<Vec3> start = system.x;
  AtomMotion motion(tersoff_set("c_1989"), system, {.dt = 5e-4});
  motion.load(loads);
  motion.step(100);
  size_t driven = 0;
  for (size_t i = 0; i < n; ++i) {
    if (!loads.imposed[i][1]) continue;
    ++driven;
    EXPECT_NEAR(motion.atoms().x[i][1] - start[i][1], 0.05 * loads.velocity[i][1], 1e-12);
    EXPECT_EQ(motion.atoms().v[i][1], loads.velocity[i][1]);
  }
  EXPECT_GT(driven, 16u);
  EXPECT_NEAR(motion.momentum()[0], 0.1 * static_cast<double>(n) * 0.05, 1e-10);  // force times time
}

TEST(AtomMotion, DragTakesSpeedAway) {
  AtomSystem one{{}, {Vec3::Zero()}, {Vec3(2, 0, 0)}, {}, {kMass}};
  AtomMotion motion(tersoff_set("c_1989"), one, {.dt = 0.01, .drag = 3});
  motion.step(100);
  EXPECT_NEAR(motion.atoms().v[0][0], 2 * std::exp(-3.0), 1e-12);
}

TEST(AtomMotion, RestsWhereTheCrystalDoes) {
  AtomSystem system = sheet(6, 4, {true, true, false});
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> move(-0.1, 0.1);
  for (Vec3& x : system.x) x += Vec3(move(random), move(random), 0);
  AtomMotion motion(tersoff_set("c_1989"), system, {});
  const AtomMotion::Rest rest = motion.rest(1e-7);
  EXPECT_TRUE(rest.reached);
  EXPECT_LE(rest.force, 1e-7);
  EXPECT_LT(rest.evaluations, 1000u);
  EXPECT_NEAR(motion.potential_energy() / static_cast<double>(system.x.size()), -7.393187, 1e-6);
}

// A slit concentrates stress: the atoms at its tips bear more than those far from it, and those at its sides
// less.
TEST(AtomMotion, RestsAroundASlit) {
  AtomSystem system = sheet(24, 14, {true, true, false});
  const Vec3 middle = system.box.edges * Vec3(0.5, 0.5, 0);
  std::erase_if(system.x, [&](const Vec3& x) {
    return std::abs(x[0] - middle[0]) < 10 && std::abs(x[1] - middle[1]) < 1.2;
  });
  AtomMotion motion(tersoff_set("c_1989"), system, {});
  motion.deform(diagonal({1, 1.02, 1}));
  const AtomMotion::Rest rest = motion.rest(1e-5);
  ASSERT_TRUE(rest.reached);
  double tip = 0, side = 0;
  const Vec3 centre = motion.atoms().box.edges * Vec3(0.5, 0.5, 0);
  size_t sides = 0;
  for (size_t i = 0; i < system.x.size(); ++i) {
    const Vec3 at = motion.atoms().x[i] - centre;
    const double pull = motion.virial_of(i)(1, 1);
    tip = std::max(tip, pull);
    if (std::abs(at[0]) < 4 && std::abs(at[1]) < 4) side += pull, ++sides;
  }
  ASSERT_GT(sides, 8u);
  const double mean = motion.virial()(1, 1) / static_cast<double>(system.x.size());
  EXPECT_GT(tip, 2 * mean);
  EXPECT_LT(side / static_cast<double>(sides), 0.4 * mean);
}

TEST(AtomMotion, TellsWhereItFails) {
  AtomMotion motion(tersoff_set("c_1989"), warm_sheet(5), {.dt = 1e200});
  try {
    motion.step(3);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 23), "step 0: the position of") << error.what();
  }
  AtomSystem none = warm_sheet(1);
  none.mass = {0};
  EXPECT_THROW(AtomMotion(tersoff_set("c_1989"), none, {}), std::invalid_argument);
  EXPECT_THROW(motion.load({std::vector<Vec3>(3), {}, {}}), std::invalid_argument);
}

}  // namespace
}  // namespace cuboct
