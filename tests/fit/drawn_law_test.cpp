// SPDX-License-Identifier: MIT
// The constraints of a drawn law, on the law as engines see it.
#include <gtest/gtest.h>

#include <random>

#include "model/contract/law.h"
#include "study/law_fit/drawn_law.h"

namespace cuboct::fit {
namespace {

constexpr LawScale kScale{.pitch = 0.5e-3, .reach = 3, .stiffness = 2e6, .height = 25};

std::shared_ptr<const PairLaw> law_of(const DrawnLaw& drawn) {
  LawPoints points = points_of(drawn);
  return spline_law(points.r, points.f, Interpolation::monotone_cubic, kScale.pitch / 2);
}

// All laws that shares in (0, 1) and forces of either sign draw.
Parameters any(std::mt19937& random) {
  const auto in = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  Parameters p{};
  p[stiffness] = in(0.5, 2), p[push_top] = in(0.1, 1);
  p[push_1] = in(0.1, 0.9), p[push_2] = in(0.1, 0.9), p[push_2_force] = in(0.3, 1.5),
  p[push_3] = in(0.02, 0.3);
  p[pull_1] = in(0.2, 2);
  for (const Parameter k : {pull_2, pull_3, pull_4}) p[k] = in(0.02, 0.8);
  for (const Parameter k : {pull_2_force, pull_3_force, pull_4_force}) p[k] = in(-1, 2);
  return p;
}

TEST(DrawnLaw, VanishesAtPitchAndReachWithOneTangentAtThePitch) {
  std::mt19937 random(1);
  int drawn = 0;
  for (; drawn < 200; ++drawn) {
    const Parameters p = any(random);
    const DrawnLaw points = draw(p, kScale);
    const auto law = law_of(points);
    const double pitch = kScale.pitch, k = p[stiffness] * kScale.stiffness, h = 1e-7 * pitch;
    EXPECT_EQ(law->force(pitch), 0);
    EXPECT_NEAR(law->force(pitch - h) / h, k, 0.02 * k);
    EXPECT_NEAR(-law->force(pitch + h) / h, k, 0.02 * k);
    EXPECT_DOUBLE_EQ(law->cutoff(), kScale.reach * pitch);
    EXPECT_LT(std::abs(law->force(law->cutoff() * (1 - 1e-9))), 1e-6 * kScale.height);
    // The polygon itself, exactly.
    EXPECT_EQ(points.push[0].r, 0);
    EXPECT_EQ(points.push[1].f, points.push[0].f);
    EXPECT_NEAR(points.push[3].f, k * (pitch - points.push[3].r), 1e-12 * k * pitch);
    EXPECT_NEAR(points.pull[1].f, k * (pitch - points.pull[1].r), 1e-12 * k * pitch);
  }
  EXPECT_EQ(drawn, 200);
}

TEST(DrawnLaw, DistancesAscendWhateverTheShares) {
  std::mt19937 random(2);
  for (int drawn = 0; drawn < 200; ++drawn) {
    const LawPoints points = points_of(draw(any(random), kScale));
    ASSERT_EQ(points.r.size(), 81U);
    for (size_t k = 1; k < points.r.size(); ++k) ASSERT_GT(points.r[k], points.r[k - 1]);
  }
}

// Knots 0 0 0 0 1 2 2 2 2: at 1 the push is (P1 + 2 P2 + P3)/4. Knots 0 0 0 0 1 2 3 3 3 3: at 1 the pull is
// (3 Q1 + 7 Q2 + 2 Q3)/12.
TEST(DrawnLaw, IsTheCubicBSplineOfItsPolygon) {
  std::mt19937 random(3);
  int drawn = 0;
  for (; drawn < 50; ++drawn) {
    const DrawnLaw law = draw(any(random), kScale);
    const auto through = law_of(law);
    const auto& [p, q] = law;
    const double r1 = (p[1].r + 2 * p[2].r + p[3].r) / 4, f1 = (p[1].f + 2 * p[2].f + p[3].f) / 4;
    const double r2 = (3 * q[1].r + 7 * q[2].r + 2 * q[3].r) / 12,
                 f2 = (3 * q[1].f + 7 * q[2].f + 2 * q[3].f) / 12;
    if (r1 > kScale.pitch / 2) {
      EXPECT_NEAR(through->force(r1), f1, 0.01 * p[0].f);
    }
    EXPECT_NEAR(through->force(r2), f2, 0.02 * kScale.height);
  }
  EXPECT_EQ(drawn, 50);
}

// Where a curve begins level, its fall goes with the square of the parameter: of the first two points that is
// ((1 - (30/32)^3)/(1 - (31/32)^3))^2 = 3.76, where a slope would make 1.94.
TEST(DrawnLaw, BeginsLevel) {
  Parameters p{};
  p[stiffness] = 1, p[push_top] = 0.4, p[push_1] = p[push_2] = 0.5, p[push_2_force] = 0.5, p[push_3] = 0.1;
  p[pull_1] = 0.8, p[pull_2] = p[pull_3] = p[pull_4] = 0.5;
  const LawPoints points = points_of(draw(p, kScale));
  EXPECT_EQ(points.f[0], 0.4 * kScale.stiffness * kScale.pitch);
  EXPECT_NEAR((points.f[2] - points.f[0]) / (points.f[1] - points.f[0]), 3.76, 0.4);
}

}  // namespace
}  // namespace cuboct::fit
