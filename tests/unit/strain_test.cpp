// SPDX-License-Identifier: MIT
#include "model/analysis/strain.h"
#include "model/base/mat3.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

namespace cuboct {
namespace {

// n^3 cubic cells of an FCC packing with nearest-neighbour distance 1.
std::vector<Vec3> fcc(int n) {
  const double a = std::sqrt(2.0);
  std::vector<Vec3> x;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (const Vec3& site : {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.5, 0, 0.5), Vec3(0, 0.5, 0.5)})
          x.push_back(a * (Vec3(i, j, k) + site));
  return x;
}

constexpr double kBetweenShells = 1.2;  // the second shell stands at sqrt 2

TEST(Strain, OfAnAffineMapIsThatMap) {
  Mat3 map;
  map << 1.03, 0.02, 0.00, -0.01, 0.98, 0.04, 0.05, 0.00, 1.10;
  const std::vector<Vec3> before = fcc(3);
  std::vector<Vec3> after;
  for (const Vec3& x : before) after.push_back(map * x + Vec3(5, -7, 1));
  int full = 0;
  for (const LocalStrain& strain : StrainMeter(before, {}, kBetweenShells).measure(after)) {
    // A corner of the cube sees three independent directions too, so every particle knows the whole map.
    EXPECT_LT((strain.gradient - map).norm(), 1e-12);
    EXPECT_LT(strain.residual, 1e-24);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(strain.axial(axis), map.col(axis).norm() - 1, 1e-12);
      EXPECT_NEAR(strain.axial(axis), std::sqrt(1 + 2 * strain.lagrangian()(axis, axis)) - 1, 1e-12);
    }
    full += strain.neighbours == 12;
  }
  EXPECT_GT(full, 0);  // an inner particle has the 12 neighbours of the packing
}

TEST(Strain, OfARotationIsZero) {
  const Mat3 turn = Eigen::AngleAxisd(0.7, eigen(Vec3(1, 2, 3).normalized())).toRotationMatrix();
  const std::vector<Vec3> before = fcc(2);
  std::vector<Vec3> after;
  for (const Vec3& x : before) after.push_back(turn * x);
  for (const LocalStrain& strain : StrainMeter(before, {}, kBetweenShells).measure(after))
    EXPECT_LT(strain.lagrangian().norm(), 1e-12);
}

TEST(Strain, SeesAcrossAPeriodicBox) {
  const int n = 2;
  const double edge = n * std::sqrt(2.0);
  const Periodic periodic{Vec3::Zero(), Vec3::Constant(edge)};
  std::vector<Vec3> x = fcc(n);
  for (const LocalStrain& strain : StrainMeter(x, periodic, kBetweenShells).measure(x)) {
    EXPECT_EQ(strain.neighbours, 12);
    EXPECT_LT(strain.lagrangian().norm(), 1e-14);
  }
  // The same particles, each in another image, are the same body.
  std::vector<Vec3> moved = x;
  for (size_t i = 0; i < moved.size(); ++i) moved[i][i % 3] += (i % 2 ? 1 : -1) * edge;
  for (const LocalStrain& strain : StrainMeter(x, periodic, kBetweenShells).measure(moved))
    EXPECT_LT(strain.lagrangian().norm(), 1e-13);
}

TEST(Strain, OfAChainIsItsStretchAndNothingAcross) {
  const std::vector<Vec3> before{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<Vec3> after{{0, 0, 0}, {1.1, 0, 0}, {2.2, 0, 0}};
  const auto strains = StrainMeter(before, {}, kBetweenShells).measure(after);
  EXPECT_EQ(strains[1].neighbours, 2);
  for (const LocalStrain& strain : strains) {
    EXPECT_NEAR(strain.axial(0), 0.1, 1e-12);
    EXPECT_NEAR(strain.axial(1), 0, 1e-12);
    EXPECT_NEAR(strain.axial(2), 0, 1e-12);
  }
}

TEST(Strain, OfALoneParticleIsZero) {
  const auto strains = StrainMeter({Vec3(1, 2, 3)}, {}, kBetweenShells).measure({Vec3(4, 5, 6)});
  EXPECT_EQ(strains[0].neighbours, 0);
  EXPECT_EQ(strains[0].axial(2), 0);
}

TEST(Strain, ResidualIsWhatNoAffineMapExplains) {
  // Two neighbours of the middle move against each other across the chain: F = 1 + 0, so each leaves its own
  // move.
  const std::vector<Vec3> before{{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  const std::vector<Vec3> after{{-1, 0.1, 0}, {0, 0, 0}, {1, 0.1, 0}};
  const auto strains = StrainMeter(before, {}, kBetweenShells).measure(after);
  EXPECT_NEAR(strains[1].residual, 0.02, 1e-12);
}

// In threads, from some 20 000 particles on, as one by one.
TEST(Strain, AxialIsThatOfEachParticle) {
  for (const int n : {3, 28}) {
    const std::vector<Vec3> before = fcc(n);
    std::vector<Vec3> after = before;
    for (size_t i = 0; i < after.size(); ++i) {
      const double t = static_cast<double>(i);
      after[i] += 0.05 * Vec3(std::sin(t), std::cos(1.7 * t), std::sin(2.3 * t));
    }
    const StrainMeter meter(before, {}, kBetweenShells);
    const auto whole = meter.measure(after);
    for (int axis = 0; axis < 3; ++axis) {
      const auto axial = meter.axial(after, axis);
      ASSERT_EQ(axial.size(), whole.size());
      for (size_t i = 0; i < axial.size(); ++i) ASSERT_EQ(axial[i], whole[i].axial(axis));
    }
  }
}

// A chain of four is pulled apart in the middle, about a periodic edge.
TEST(Strain, DeformationsCountBrokenNeighboursAndHoldTheTensor) {
  const Periodic periodic{Vec3::Zero(), Vec3(8, 0, 0)};
  const std::vector<Vec3> before{{7, 0, 0}, {0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<Vec3> after{{7, 0, 0}, {0, 0, 0}, {1.6, 0, 0}, {2.6, 0, 0}};
  const StrainMeter meter(before, periodic, kBetweenShells);
  const auto all = meter.deformations(after, 0, [](uint32_t, uint32_t) { return 1.5; });
  const auto whole = meter.measure(after);
  const auto counts = meter.broken(after, [](uint32_t, uint32_t) { return 1.5; });
  const uint32_t broken[] = {0, 1, 1, 0};
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(all[i].broken, broken[i]) << i;
    EXPECT_EQ(counts[i], broken[i]) << i;
    EXPECT_EQ(all[i].axial, whole[i].axial(0));
    EXPECT_FLOAT_EQ(all[i].strain[0], static_cast<float>(whole[i].lagrangian()(0, 0)));
    for (int k = 1; k < 6; ++k) EXPECT_NEAR(all[i].strain[static_cast<size_t>(k)], 0, 1e-7);
  }
  // Out of reach from the start: no bond that could break.
  const auto short_reach = [](uint32_t, uint32_t) { return 0.9; };
  for (const Deformation& one : meter.deformations(after, 0, short_reach)) EXPECT_EQ(one.broken, 0u);
  // Each pair has a reach of its own.
  const auto longer_at_0 = [](uint32_t i, uint32_t j) { return i == 1 || j == 1 ? 1.7 : 1.5; };
  for (const Deformation& one : meter.deformations(after, 0, longer_at_0)) EXPECT_EQ(one.broken, 0u);
  // Shear in the plane of x and y: e_xy = 1/2 of the shift per height.
  std::vector<Vec3> block = fcc(2), sheared = block;
  for (Vec3& x : sheared) x[0] += 0.02 * x[1];
  for (const Deformation& one :
       StrainMeter(block, {}, kBetweenShells).deformations(sheared, 0, [](uint32_t, uint32_t) {
         return 9.0;
       }))
    EXPECT_NEAR(one.strain[3], 0.01, 1e-6);
}

}  // namespace
}  // namespace cuboct
