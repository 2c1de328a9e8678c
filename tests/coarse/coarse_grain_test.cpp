// SPDX-License-Identifier: MIT
// Coarse-graining across cracks, in two and three dimensions: sums that must balance, linear fields, and a
// jump that is known.
#include "model/atoms/coarse/coarse_grain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/base/error.h"
#include "model/base/mat3.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

// Atoms at random about a lattice of spacing 1, points of spacing 4 at the middles of their cells.
struct Matter {
  int dimensions;
  std::vector<Vec3> x;
  std::vector<double> mass;
  CoarsePoints points;

  explicit Matter(int d) : dimensions(d) {
    const int cells = d == 3 ? 3 : 6;
    const double radius = d == 3 ? 1.5 : 2;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> shift(-0.2, 0.2), weight(1, 3);
    const int atoms = 4 * cells;
    for (int a = 0; a < atoms; ++a)
      for (int b = 0; b < atoms; ++b)
        for (int c = 0; c < (d == 3 ? atoms : 1); ++c) {
          x.emplace_back(a + 0.5 + shift(random), b + 0.5 + shift(random),
                         d == 3 ? c + 0.5 + shift(random) : 7);
          mass.push_back(weight(random));
        }
    points.dimensions = d, points.radius = 4 * radius, points.volume = std::pow(4, d);
    for (int a = 0; a < cells; ++a)
      for (int b = 0; b < cells; ++b)
        for (int c = 0; c < (d == 3 ? cells : 1); ++c)
          points.x.emplace_back(4 * a + 2, 4 * b + 2, d == 3 ? 4 * c + 2 : 0);
  }
  // Opened along x at x = 8, between points, by `jump`.
  std::vector<Vec3> opened(double jump) const {
    std::vector<Vec3> u;
    for (const Vec3& at : x) u.emplace_back(side(at) * jump / 2, 0, 0);
    return u;
  }
  double side(const Vec3& at) const { return at[0] < 8 ? -1 : 1; }
};

constexpr CrackSight kSight{.noise = 0.02, .tube = 1.5};

class Coarse : public testing::TestWithParam<int> {};

Vec3 sum(const std::vector<Vec3>& items) {
  Vec3 out = Vec3::Zero();
  for (const Vec3& item : items) out += item;
  return out;
}

TEST_P(Coarse, KeepsMassForceAndMomentum) {
  const Matter m(GetParam());
  CoarseGrain grain(m.points, m.x, m.mass);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  std::vector<Vec3> force(m.x.size()), velocity(m.x.size());
  for (Vec3& f : force) f = {normal(random), normal(random), normal(random)};
  for (Vec3& v : velocity) v = {normal(random), normal(random), normal(random)};
  double mass = 0;
  Vec3 momentum = Vec3::Zero();
  for (size_t i = 0; i < m.x.size(); ++i) mass += m.mass[i], momentum += m.mass[i] * velocity[i];
  for (const bool cracked : {false, true}) {
    if (cracked) grain.look(m.opened(2), {0.05});
    const std::vector<double> density = grain.density();
    const std::vector<Vec3> mean = grain.mean(velocity);
    double mass_of_points = 0;
    Vec3 momentum_of_points = Vec3::Zero();
    for (size_t p = 0; p < density.size(); ++p) {
      mass_of_points += density[p] * m.points.volume;
      momentum_of_points += density[p] * m.points.volume * mean[p];
    }
    EXPECT_NEAR(mass_of_points / mass, 1, 1e-12);
    EXPECT_LT((momentum_of_points - momentum).norm(), 1e-12 * mass);
    EXPECT_LT((sum(grain.density_of(force)) * m.points.volume - sum(force)).norm(),
              1e-9 * std::sqrt(m.x.size()));
  }
}

TEST_P(Coarse, HasLinearFieldsExactly) {
  const Matter m(GetParam());
  CoarseGrain grain(m.points, m.x, m.mass);
  Mat3 slope;
  slope << 0.1, -0.2, 0.05, 0.3, 0.02, -0.07, 0.11, 0.05, -0.3;
  const auto at = [&](Vec3 x) {
    if (m.dimensions == 2) x[2] = 0;
    return Vec3(slope * x + Vec3(1, 2, 3));
  };
  std::vector<Vec3> u;
  for (const Vec3& x : m.x) u.push_back(at(x));
  const auto centres = grain.mean(m.x), plain = grain.mean(u), linear = grain.linear_mean(u);
  double off = 0;
  for (size_t p = 0; p < plain.size(); ++p) {
    EXPECT_LT((plain[p] - at(centres[p])).norm(), 1e-12);
    EXPECT_LT((linear[p] - at(m.points.x[p])).norm(), 1e-11);
    off = std::max(off, (plain[p] - at(m.points.x[p])).norm());
  }
  EXPECT_GT(off, 0.1);  // at the edges the plain mean is that of a place further in
}

// A body in two halves that moved apart: each point is on its own half.
TEST_P(Coarse, KeepsAJumpSharp) {
  const Matter m(GetParam());
  CoarseGrain grain(m.points, m.x, m.mass);
  const std::vector<Vec3> u = m.opened(2);
  const auto worst = [&](const std::vector<Vec3>& mean) {
    double off = 0;
    for (size_t p = 0; p < mean.size(); ++p)
      off = std::max(off, (mean[p] - Vec3(m.side(m.points.x[p]), 0, 0)).norm());
    return off;
  };
  EXPECT_GT(worst(grain.mean(u)), 0.3);  // smeared: of the way from 1 to 0
  grain.look(u, kSight);
  // The error of two lines is 0, that of one over the number of pairs at most J^2/4, at least J^2/16 where
  // the jump is halfway: alpha is some 0.02^2 to 0.01.
  EXPECT_LT(worst(grain.mean(u)), 0.05);
  EXPECT_LT(worst(grain.linear_mean(u)), 0.05);
}

// Where nothing is cracked, the weights stay.
TEST_P(Coarse, LeavesSmoothFieldsAlone) {
  const Matter m(GetParam());
  CoarseGrain grain(m.points, m.x, m.mass);
  std::vector<Vec3> u;
  for (const Vec3& x : m.x) u.emplace_back(0.1 * x[0] + 0.002 * x[1] * x[1], 0.02 * x[1], 0);
  const auto before = grain.mean(u);
  grain.look(u, {.noise = 0.2, .tube = 1.5});
  const auto after = grain.mean(u);
  for (size_t p = 0; p < before.size(); ++p) EXPECT_LT((before[p] - after[p]).norm(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Coarse, testing::Values(2, 3));

TEST(Smoothness, IsThatOfTwoLinesOverOne) {
  using Pairs = std::vector<std::pair<double, double>>;
  Pairs line{{0, 1}, {1, 3}, {2, 5}, {3, 7}, {4, 9}};
  EXPECT_EQ(smoothness_of(line, 0.1), 1);
  // A step of height 1 in the middle of four: one line has u = d 2/5 + 1/2 about the means; its squared error
  // is 1 - 4/5 = 1/5.
  Pairs step{{3, 1}, {0, 0}, {2, 1}, {1, 0}};
  EXPECT_NEAR(smoothness_of(step, 0), 0, 1e-12);
  EXPECT_NEAR(smoothness_of(step, 0.1), 4 * 0.01 / (0.2 + 4 * 0.01), 1e-12);
  // 0, 1, 4, 9: one line leaves 4, those of {0, 1} and {4, 9} nothing.
  Pairs curve{{0, 0}, {1, 1}, {2, 4}, {3, 9}};
  EXPECT_NEAR(smoothness_of(curve, 0.5), 4 * 0.25 / (4 + 4 * 0.25), 1e-12);
  Pairs none;
  EXPECT_EQ(smoothness_of(none, 0.1), 1);
}

TEST(CoarseRefuses, AtomsAndPointsThatAreAlone) {
  Matter m(2);
  CoarsePoints away = m.points;
  away.x.emplace_back(100, 0, 0);
  EXPECT_EQ(
      refused_with([&] { CoarseGrain(away, m.x, m.mass); }),
      "point 36 at (100, 0, 0) has no atom within 8\n  hint: a larger radius, or points where atoms are");
  std::vector<Vec3> x = m.x;
  x[3] = {50, 1, 0};
  EXPECT_EQ(refused_with([&] { CoarseGrain(m.points, x, m.mass); }),
            "atom 3 at (50, 1, 0) is within 8 of no point\n  hint: a larger radius, or more points");
  CoarseGrain grain(m.points, m.x, m.mass);
  std::vector<Vec3> u(m.x.size(), Vec3::Zero());
  u[7][1] = std::nan("");
  EXPECT_EQ(refused_with([&] { grain.look(u, kSight); }), "the displacement of atom 7 is not finite");
}

// Repeating along x, all points are alike.
TEST(CoarsePeriodic, HasNoEnds) {
  Matter m(2);
  m.points.period = {24, 24, 0};
  const CoarseGrain grain(m.points, m.x, std::vector<double>(m.x.size(), 1));
  for (const double density : grain.density()) EXPECT_NEAR(density, 1, 0.03);  // an atom in an area of 1
}

}  // namespace
}  // namespace cuboct
