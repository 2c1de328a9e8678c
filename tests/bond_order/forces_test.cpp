// SPDX-License-Identifier: MIT
// Tersoff's forces and virial by themselves: slopes of the energy, and what they must not depend on.
// tests/peer/tersoff_test.cpp compares them with LAMMPS.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "model/atoms/bond_order/atom_cell.h"
#include "model/base/mat3.h"

namespace cuboct {
namespace {

struct Result {
  std::vector<Vec3> f;
  double energy = 0;
  Mat3 virial;
};

Result evaluated(TersoffForces& forces, const AtomCell& cell, TersoffAsked asked = {}) {
  asked.sums = true;
  BondList list(forces.tersoff().cutoff(), 0.3, bond_lanes());
  list.update(cell.box, cell.x);
  Result result{std::vector<Vec3>(cell.x.size()), 0, {}};
  forces.evaluate(list, cell.box, cell.x, result.f, asked);
  result.energy = forces.energy(), result.virial = forces.virial();
  return result;
}

// A cell whose atoms are moved at random by up to `most` along each axis.
AtomCell shaken(AtomCell cell, double most, uint64_t seed = 7) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> move(-most, most);
  for (Vec3& x : cell.x) x += Vec3(move(random), move(random), move(random));
  return cell;
}

// Three cubes of silicon, sheared and open along z, so that some atoms lack neighbours.
AtomCell sheared_slab() {
  Mat3 strain = Mat3::Zero();
  strain(0, 1) = 0.08, strain(0, 0) = 0.03, strain(1, 2) = -0.05;
  AtomCell cell = shaken(strained(diamond_block(5.43, 2, 1, 2), strain), 0.25);
  cell.box.periodic[2] = false;
  return cell;
}

class TersoffSet : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Sets, TersoffSet,
                         testing::Values("si_1988", "si_1989", "si_erhart_albe", "si_multiscale"),
                         [](const auto& info) { return std::string(info.param); });

// Central differences of step h err by h^2 of the third derivative and by the energy's rounding over h: at
// 1e-5 of an angstrom some 1e-8 of the largest force.
TEST_P(TersoffSet, ForcesAreTheEnergysSlope) {
  TersoffForces forces(tersoff_set(GetParam()));
  AtomCell cell = sheared_slab();
  const Result here = evaluated(forces, cell);
  double largest = 0;
  for (const Vec3& f : here.f) largest = std::max(largest, f.norm());
  ASSERT_GT(largest, 1);
  constexpr double kStep = 1e-5;
  for (size_t i = 0; i < cell.x.size(); i += 3)
    for (int a = 0; a < 3; ++a) {
      const double at = cell.x[i][a];
      cell.x[i][a] = at + kStep;
      const double ahead = evaluated(forces, cell).energy;
      cell.x[i][a] = at - kStep;
      const double behind = evaluated(forces, cell).energy;
      cell.x[i][a] = at;
      EXPECT_NEAR(here.f[i][a], (behind - ahead) / (2 * kStep), 3e-7 * largest)
          << "atom " << i << " axis " << a;
    }
}

TEST_P(TersoffSet, VirialIsTheSlopeByStrain) {
  TersoffForces forces(tersoff_set(GetParam()));
  AtomCell cell = sheared_slab();
  cell.box.periodic[2] = true;
  const Result here = evaluated(forces, cell);
  constexpr double kStep = 1e-6;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      Mat3 strain = Mat3::Zero();
      strain(a, b) = kStep;
      const double ahead = evaluated(forces, strained(cell, strain)).energy;
      const double behind = evaluated(forces, strained(cell, -strain)).energy;
      EXPECT_NEAR(here.virial(a, b), (ahead - behind) / (2 * kStep), 1e-6 * here.virial.norm()) << a << b;
    }
}

TEST_P(TersoffSet, NeitherPushesNorTurnsAFreeBody) {
  TersoffForces forces(tersoff_set(GetParam()));
  AtomCell cell = sheared_slab();
  cell.box.periodic = {false, false, false};
  const Result here = evaluated(forces, cell);
  Vec3 push = Vec3::Zero(), turn = Vec3::Zero();
  double size = 0;
  for (size_t i = 0; i < cell.x.size(); ++i) {
    push += here.f[i], turn += cell.x[i].cross(here.f[i]);
    size += here.f[i].norm();
  }
  EXPECT_LT(push.norm(), 1e-13 * size);
  EXPECT_LT(turn.norm(), 1e-12 * size);  // arms of some 10 angstrom
}

TEST_P(TersoffSet, TurnsWithItsAtoms) {
  TersoffForces forces(tersoff_set(GetParam()));
  AtomCell cell = sheared_slab();
  const Result here = evaluated(forces, cell);
  const Mat3 turn = Eigen::AngleAxisd(1.1, eigen(Vec3(1, -2, 0.5).normalized())).toRotationMatrix();
  const Result turned = evaluated(forces, strained(cell, turn - Mat3::Identity()));
  EXPECT_NEAR(turned.energy, here.energy, 1e-12 * std::abs(here.energy));
  for (size_t i = 0; i < cell.x.size(); ++i)
    EXPECT_LT((turned.f[i] - turn * here.f[i]).norm(), 1e-11 * (1 + here.f[i].norm())) << "atom " << i;
  EXPECT_LT((turned.virial - turn * here.virial * turn.transpose()).norm(), 1e-11 * here.virial.norm());
}

// The vectors' formulas against those of tersoff_terms.h, which serve several elements: here two of one kind.
// The bound is some hundred roundings of the largest terms, 1e3 eV/angstrom.
TEST_P(TersoffSet, VectorsAreThePlainFormulas) {
  const Tersoff one = tersoff_set(GetParam());
  TersoffForces forces(one), plain(Tersoff{{"Si", "Si"}, std::vector<TersoffTerm<double>>(8, one.terms[0])});
  for (const double shake : {0.1, 0.3, 0.6}) {
    const AtomCell cell = shaken(sheared_slab(), shake, 11);
    std::vector<uint8_t> element(cell.x.size());
    for (size_t i = 0; i < element.size(); ++i) element[i] = i % 2;
    const Result a = evaluated(forces, cell), b = evaluated(plain, cell, {.element = element});
    EXPECT_NEAR(a.energy, b.energy, 1e-12 * std::abs(b.energy));
    EXPECT_LT((a.virial - b.virial).norm(), 1e-11 * b.virial.norm());
    for (size_t i = 0; i < cell.x.size(); ++i)
      EXPECT_LT((a.f[i] - b.f[i]).norm(), 1e-11 * (1 + b.f[i].norm())) << "atom " << i << " of " << shake;
  }
}

TEST(Tersoff, ThreadsAndListsLeaveNoMark) {
  TersoffForces forces(tersoff_set("si_1988"));
  AtomCell cell = shaken(diamond_block(5.43, 8, 8, 8), 0.3);
  std::vector<Vec3> one(cell.x.size()), other = one;
  for (const double skin : {0.0, 0.5, 1.5}) {
    BondList list(forces.tersoff().cutoff(), skin, bond_lanes());
    list.update(cell.box, cell.x);
    forces.evaluate(list, cell.box, cell.x, one, {.sums = true});
    const double energy = forces.energy();
    const Mat3 virial = forces.virial();
    forces.evaluate(list, cell.box, cell.x, other, {.sums = true, .threads = 3});
    EXPECT_EQ(energy, forces.energy());
    EXPECT_EQ(virial, forces.virial());
    for (size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i], other[i]) << "atom " << i << " skin " << skin;
    if (skin > 0) continue;
    // The list of another skin is the same sum with zeros in between.
    BondList longer(forces.tersoff().cutoff(), 1.0, bond_lanes());
    longer.update(cell.box, cell.x);
    ASSERT_GT(longer.rows(), list.rows());
    forces.evaluate(longer, cell.box, cell.x, other);
    for (size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one[i], other[i]) << "atom " << i;
  }
}

}  // namespace
}  // namespace cuboct
