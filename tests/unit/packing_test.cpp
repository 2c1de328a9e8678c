// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

#include "model/base/mat3.h"
#include "model/body/packing.h"

namespace cuboct {
namespace {

int neighbours(const std::vector<Vec3>& x, const Vec3& at, double distance,
               const Vec3& period = Vec3::Zero()) {
  int count = 0;
  for (const Vec3& other : x) {
    Vec3 d = other - at;
    for (int a = 0; a < 3; ++a)
      if (period[a] > 0) d[a] -= period[a] * std::round(d[a] / period[a]);
    count += std::abs(d.norm() - distance) < 1e-9 * distance;
  }
  return count;
}

// Four particles per conventional cell, and in a periodic box every one has the shells of the FCC lattice.
TEST(Packing, PeriodicBoxIsPerfect) {
  Fcc fcc{.pitch = 0.5e-3};
  Periodic box{.origin = {1, 2, 3}, .extent = Vec3(3, 4, 5) * fcc.cell()};
  fcc.offset = box.origin;  // sites lie on the box's faces: each must come once
  const auto x = pack(fcc, nullptr, box);
  ASSERT_EQ(x.size(), 4U * 3 * 4 * 5);
  for (const Vec3& site : x) {
    EXPECT_EQ(neighbours(x, site, fcc.pitch, box.extent), 12);
    EXPECT_EQ(neighbours(x, site, std::sqrt(2) * fcc.pitch, box.extent), 6);
    EXPECT_EQ(neighbours(x, site, std::sqrt(3) * fcc.pitch, box.extent), 24);
    for (int a = 0; a < 3; ++a)
      EXPECT_TRUE(site[a] >= box.origin[a] && site[a] < box.origin[a] + box.extent[a]);
  }
}

// LAMMPS-like orientation x = [110], y = [-110], z = [001]: the repeats are a*|hkl| with 8 particles in one.
TEST(Packing, TurnedPeriodicBoxIsPerfect) {
  Fcc fcc{.pitch = 1};
  fcc.orientation.row(0) = eigen(Vec3(1, 1, 0).normalized());
  fcc.orientation.row(1) = eigen(Vec3(-1, 1, 0).normalized());
  fcc.orientation.row(2) = eigen(Vec3(0, 0, 1));
  const Vec3 repeat(std::sqrt(2) * fcc.cell(), std::sqrt(2) * fcc.cell(), fcc.cell());
  Periodic box{.origin = Vec3::Zero(), .extent = 3 * repeat};
  const auto x = pack(fcc, nullptr, box);
  ASSERT_EQ(x.size(), 27U * 8);
  for (const Vec3& site : x) EXPECT_EQ(neighbours(x, site, 1, box.extent), 12);
  EXPECT_TRUE(is_period(fcc, {box.extent[0], 0, 0}));
  EXPECT_TRUE(is_period(fcc, {1, 0, 0}));  // [110] is a close-packed row
  EXPECT_FALSE(is_period(fcc, {0.5, 0, 0}));
  EXPECT_FALSE(is_period(fcc, {0, 0, fcc.cell() / 2}));
  EXPECT_TRUE(is_period(fcc, {0, 0, -fcc.cell()}));
}

// The number of sites in a body is its volume over pitch^3/sqrt(2), within its surface times a pitch, in any
// turn; so density is kept.
TEST(Packing, CountFollowsVolume) {
  Fcc fcc{.pitch = 0.1,
          .orientation = Eigen::AngleAxisd(0.4, eigen(Vec3(1, 2, 3).normalized())).toRotationMatrix(),
          .offset = {0.01, 0.02, 0.03}};
  const double radius = 1;
  const auto ball = sphere({0.3, 0.2, 0.1}, radius);
  const auto x = pack(fcc, ball.get(), {});
  const double expected =
      4.0 / 3 * std::numbers::pi * std::pow(radius, 3) * std::sqrt(2) / std::pow(fcc.pitch, 3);
  EXPECT_NEAR(static_cast<double>(x.size()), expected, 0.01 * expected);
  EXPECT_NEAR(particle_mass(1410, 0.1) * expected, 1410 * 4.0 / 3 * std::numbers::pi, 1e-9 * 6000);
  for (const Vec3& site : x) EXPECT_LE(ball->distance(site), 1e-6 * fcc.pitch);
  EXPECT_EQ(neighbours(x, x[x.size() / 2], fcc.pitch), 12);
}

// A cube of n cells, surface included, has 4n^3 + 6n^2 + 3n + 1 sites, whether its faces are given a rounding
// error outside or inside the sites.
TEST(Packing, SurfaceSitesAreSafe) {
  const Fcc fcc{.pitch = 0.3e-3};
  for (int n : {1, 3, 7}) {
    for (double wrong : {-1e-9, 0.0, 1e-9}) {
      const Vec3 corner = Vec3::Constant(n * fcc.cell() * (1 + wrong));
      const auto cube = box(Vec3::Constant(-wrong * fcc.pitch), corner);
      EXPECT_EQ(pack(fcc, cube.get(), {}).size(), 4U * n * n * n + 6 * n * n + 3 * n + 1);
    }
  }
}

// Sites that are passed over as far from the surface are as those around them: all sites of the bounds, each
// held against the shape, are the same.
TEST(Packing, SitesThatArePassedOverAreOutside) {
  const Fcc fcc{.pitch = 0.1, .offset = {0.01, 0.02, 0.03}};
  const auto rod = capsule({0, 0, 0}, {3, 3, 3}, 0.15), ball = sphere({2.5, 0.3, 0.5}, 0.3);
  for (const ShapePtr& shape : {rod, unite({rod, ball}), subtract(ball, {sphere({2.5, 0.3, 0.5}, 0.2)})}) {
    std::vector<Vec3> expected;
    const Periodic bounds{.origin = shape->bounds().low,
                          .extent = shape->bounds().high - shape->bounds().low};
    for (const Vec3& x : pack(fcc, nullptr, bounds))
      if (shape->distance(x) <= 1e-7) expected.push_back(x);
    EXPECT_EQ(pack(fcc, shape.get(), {}), expected);
    EXPECT_GT(expected.size(), 50U);
  }
}

// A thin rod along the diagonal of a cube of 4e10 sites: the rows of the cube, and a few looks at each.
TEST(Packing, WorkOfAThinBodyIsThatOfItsSurface) {
  const auto rod = capsule({0, 0, 0}, {1, 1, 1}, 1e-3);
  const PackingSize size = packing_size({.pitch = 3.3e-4}, rod.get(), {});
  EXPECT_GT(size.tested, 1.8e7);
  EXPECT_LT(size.tested, 3e8);
  const auto ball = sphere({0, 0, 0}, 0.5);
  EXPECT_LT(packing_size({.pitch = 3.3e-4}, ball.get(), {}).tested, 1e9);
}

// Rows of the crystal that pass a thin body by are not tested; none is lost, none comes in another order.
// Oracle: every site of a ball around it.
TEST(Packing, AThinTurnedPlateLosesNoSite) {
  const Vec3 turns[] = {{1, 2, 3}, {1, 0, 0}, {-3, 1, 0.1}};
  for (const Vec3& axis : turns)
    for (const double angle : {0.0, 0.7, M_PI / 4, M_PI / 2}) {
      const Fcc fcc{.pitch = 0.1,
                    .orientation = Eigen::AngleAxisd(angle, eigen(axis.normalized())).toRotationMatrix(),
                    .offset = {0.01, 0.02, 0.03}};
      const auto plate = box(Vec3(0.3, -0.2, 0.1), Vec3(2.3, 0.9, 0.25));
      const auto ball = sphere({1.3, 0.35, 0.175}, 1.5);
      std::vector<Vec3> expected;
      for (const Vec3& site : pack(fcc, ball.get(), {}))
        if (plate->distance(site) <= 1e-6 * fcc.pitch) expected.push_back(site);
      EXPECT_GT(expected.size(), 200U);
      EXPECT_EQ(pack(fcc, plate.get(), {}), expected) << angle;
    }
}

TEST(Packing, OrderIsThatOfTheIndices) {
  const Fcc fcc{.pitch = 1};
  const auto x = pack(fcc, nullptr, {.origin = Vec3::Zero(), .extent = Vec3::Constant(fcc.cell())});
  const double h = fcc.cell() / 2;
  const std::vector<Vec3> expected = {{0, 0, 0}, {h, h, 0}, {h, 0, h}, {0, h, h}};
  ASSERT_EQ(x.size(), 4U);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(x[i], expected[i]) << i;
}

// Mean 0 exactly as far as doubles go; variance and the fourth moment (3 sigma^4) of a normal distribution
// within five standard errors; another seed gives other numbers.
TEST(Packing, ThermalVelocitiesAreNormal) {
  const size_t n = 20000;
  std::vector<uint32_t> ids(n);
  std::iota(ids.begin(), ids.end(), 0U);
  std::vector<Vec3> v(n, Vec3::Zero()), w = v, again = v;
  add_thermal(v, ids, 2.0, 1);
  add_thermal(w, ids, 2.0, 2);
  add_thermal(again, ids, 2.0, 1);
  EXPECT_EQ(v[17], again[17]);
  EXPECT_NE(v[17], w[17]);
  Vec3 sum = Vec3::Zero();
  double second = 0, fourth = 0, cross = 0;
  for (const Vec3& u : v) {
    sum += u;
    second += u.squaredNorm();
    fourth += u.cwiseAbs2().squaredNorm();
    cross += u[0] * u[1] + u[1] * u[2] + u[2] * u[0];
  }
  const double count = 3.0 * n;
  EXPECT_LT(sum.norm(), 1e-9);
  EXPECT_NEAR(second / count, 4.0, 5 * 4.0 * std::sqrt(2 / count));
  EXPECT_NEAR(fourth / count, 48.0, 5 * 16.0 * std::sqrt(96 / count));
  EXPECT_NEAR(cross / count, 0.0, 5 * 4.0 / std::sqrt(count));
}

// The generator's first two numbers by hand: Box-Muller on mt19937_64(seed 5489), whose first outputs are
// part of the C++ standard's own check (its 10000th is 9981545732273789042).
TEST(Packing, GeneratorIsTheStandardOne) {
  std::vector<Vec3> v(2, Vec3::Zero());
  add_thermal(v, {0, 1}, 1.0, 5489);
  const double u1 = (static_cast<double>(14514284786278117030ULL >> 11) + 0.5) * 0x1p-53;
  const double u2 = (static_cast<double>(4620546740167642908ULL >> 11) + 0.5) * 0x1p-53;
  const double first = std::sqrt(-2 * std::log(u1)) * std::cos(2 * std::numbers::pi * u2);
  const double second = std::sqrt(-2 * std::log(u1)) * std::sin(2 * std::numbers::pi * u2);
  // The mean of the two particles is taken off; their difference is untouched by it. Components of particle 0
  // are the deviates 0, 1, 2 and of particle 1 the deviates 3, 4, 5.
  EXPECT_DOUBLE_EQ(v[0][0], -v[1][0]);
  std::vector<Vec3> one(1, Vec3::Zero());
  add_thermal(one, {0}, 1.0, 5489);
  EXPECT_EQ(one[0], Vec3::Zero());
  std::vector<Vec3> many(1000, Vec3::Zero());
  std::vector<uint32_t> ids(1000);
  std::iota(ids.begin(), ids.end(), 0U);
  add_thermal(many, ids, 1.0, 5489);
  EXPECT_NEAR(many[0][0], first, 5 / std::sqrt(1000));
  EXPECT_NEAR(many[0][1], second, 5 / std::sqrt(1000));
}

}  // namespace
}  // namespace cuboct
