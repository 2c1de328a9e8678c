// SPDX-License-Identifier: MIT
#include "model/contract/neighbours.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "model/base/error.h"
#include "tests/fcc_block.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using Pairs = std::set<std::pair<uint32_t, uint32_t>>;

Pairs by_cells(const std::vector<Vec3>& x, double cutoff, const Periodic& periodic) {
  CellList cells(cutoff, periodic);
  cells.build(x);
  Pairs pairs;
  cells.for_each_pair(x, [&](uint32_t i, uint32_t j, const Vec3& d, double r) {
    EXPECT_TRUE(pairs.insert({std::min(i, j), std::max(i, j)}).second) << i << ' ' << j << " came twice";
    EXPECT_NEAR(d.norm(), r, 1e-15);
  });
  return pairs;
}

// Every pair, every image.
Pairs by_force(const std::vector<Vec3>& x, double cutoff, const Periodic& periodic) {
  Pairs pairs;
  for (uint32_t i = 0; i < x.size(); ++i) {
    for (uint32_t j = i + 1; j < x.size(); ++j) {
      for (int image = 0; image < 125; ++image) {
        const Vec3 n(image % 5 - 2, image / 5 % 5 - 2, image / 25 - 2);
        const double r = (x[j] - x[i] + n.cwiseProduct(periodic.extent)).norm();
        if (r < cutoff) pairs.insert({i, j});
      }
    }
  }
  return pairs;
}

TEST(CellList, FindsThePairsOfBruteForce) {
  std::mt19937_64 generator(1);
  int cases = 0;
  size_t pairs = 0;
  for (int periodic_axes = 0; periodic_axes < 8; ++periodic_axes) {
    // From exactly two cutoffs, by boxes of 2, 3 and 4 cells, to one that is long along x.
    for (const Vec3& extent : {Vec3(2, 2, 2), Vec3(2.9, 3.0, 3.1), Vec3(4.5, 2.5, 3.7), Vec3(9, 2.2, 2.2)}) {
      Periodic box;
      box.origin = Vec3(0.3, -7, 2);
      for (int axis = 0; axis < 3; ++axis) box.extent[axis] = periodic_axes >> axis & 1 ? extent[axis] : 0;
      std::vector<Vec3> x;
      for (int i = 0; i < 60; ++i) {
        // Some outside the box: in periodic axes that is allowed.
        x.push_back(box.origin + 0.5 * extent + 0.7 * extent.cwiseProduct(test::random_vector(generator)));
      }
      x[0] = box.origin;
      x[1] = box.origin + extent + Vec3::Constant(1e-9);
      x[2] = box.origin - Vec3::Constant(1e-9);
      const Pairs expected = by_force(x, 1, box);
      EXPECT_EQ(by_cells(x, 1, box), expected);
      pairs += expected.size();
      ++cases;
    }
  }
  EXPECT_EQ(cases, 32);
  EXPECT_GT(pairs, 5000u);
}

TEST(CellList, CutoffIsExclusive) {
  const Periodic open;
  EXPECT_EQ(by_cells({Vec3(0, 0, 0), Vec3(1, 0, 0)}, 1, open).size(), 0u);
  EXPECT_EQ(by_cells({Vec3(0, 0, 0), Vec3(std::nextafter(1, 0), 0, 0)}, 1, open).size(), 1u);
  EXPECT_EQ(by_cells({Vec3(0, 0, 0), Vec3(0, 0, 0)}, 1, open).size(), 0u);  // no direction
  EXPECT_EQ(by_cells({}, 1, open).size(), 0u);
}

// Cells cannot be more than particles allow, or a particle that flew away would take all memory.
TEST(CellList, TakesParticlesThatAreFarApart) {
  EXPECT_EQ(by_cells({Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(1e12, -1e12, 1e12), Vec3(1e12, -1e12, 1e12 + 0.5)},
                     1, {}),
            (Pairs{{0, 1}, {2, 3}}));
}

TEST(CellList, RefusesABoxBelowTwoCutoffs) {
  Periodic box;
  box.extent = Vec3(0, 1.99, 4);
  EXPECT_EQ(refused_with([&] { CellList cells(1, box); }),
            "the periodic box is 1.99 m long along y, less than two cutoffs (2 m)");
}

TEST(CellList, NamesAParticleWithoutAPosition) {
  CellList cells(1, {});
  const std::vector<Vec3> x{Vec3(0, 0, 0), Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0)};
  EXPECT_EQ(refused_with<std::runtime_error>([&] { cells.build(x); }), "particle 1 has no finite position");
}

}  // namespace
}  // namespace cuboct
