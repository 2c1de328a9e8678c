// SPDX-License-Identifier: MIT
#include "model/lattice.h"

#include <gtest/gtest.h>

#include <random>

namespace cuboct {
namespace {

std::vector<Cell> box(int nx, int ny, int nz) {
  std::vector<Cell> cells;
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) cells.push_back({x, y, z});
  return cells;
}

TEST(Lattice, BoxHasItsLinksInOrder) {
  const Lattice lattice(box(3, 2, 1), {0, 0, 0});
  ASSERT_EQ(lattice.size(), 6u);
  EXPECT_EQ(lattice.cell(1), (Cell{1, 0, 0}));  // (z, y, x) order
  EXPECT_EQ(lattice.cell(3), (Cell{0, 1, 0}));
  EXPECT_EQ(lattice.neighbour(1, 0), 0u);
  EXPECT_EQ(lattice.neighbour(1, 1), 2u);
  EXPECT_EQ(lattice.neighbour(1, 2), kNoNode);
  EXPECT_EQ(lattice.neighbour(1, 3), 4u);
  EXPECT_EQ(lattice.neighbour(1, 5), kNoNode);
  EXPECT_EQ(lattice.neighbourhood(1).size(), 6u);
  EXPECT_EQ(lattice.neighbourhood(0).size(), 4u);
}

TEST(Lattice, RingsWrap) {
  const Lattice lattice(box(3, 4, 5), {3, 4, 5});
  EXPECT_EQ(lattice.neighbour(0, 0), 2u);
  EXPECT_EQ(lattice.find({-1, 4, 5}), 2u);
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    const auto near = lattice.neighbourhood(n);
    ASSERT_EQ(near.size(), 27u);
    for (size_t i = 0; i < 27; ++i)
      for (size_t j = i + 1; j < 27; ++j) ASSERT_NE(near[i].node, near[j].node);
  }
}

// Two cells that touch at a corner need the cells on the way x, then y, then z, in both directions.
TEST(Lattice, ClosesTheWayAroundACorner) {
  const Lattice lattice({{0, 0, 0}, {1, 1, 1}}, {0, 0, 0});
  for (const Cell& way : {Cell{1, 0, 0}, Cell{1, 1, 0}, Cell{0, 1, 1}, Cell{0, 0, 1}})
    EXPECT_NE(lattice.find(way), kNoNode);
  const Lattice apart({{0, 0, 0}, {2, 0, 0}}, {0, 0, 0});
  EXPECT_EQ(apart.size(), 2u);
}

// From any node, its neighbourhood by links is all cells of the set around it: brute force as the oracle.
TEST(Lattice, NeighbourhoodByLinksIsWhatCoordinatesSay) {
  std::mt19937_64 random(5);
  size_t added = 0;
  for (int round = 0; round < 50; ++round) {
    std::vector<Cell> cells;
    for (int k = 0; k < 40; ++k)
      cells.push_back(
          {static_cast<int>(random() % 7), static_cast<int>(random() % 7), static_cast<int>(random() % 7)});
    const Lattice lattice(cells, {0, 0, 0});
    added += lattice.size() - 30;
    for (uint32_t n = 0; n < lattice.size(); ++n) {
      size_t count = 0;
      for (uint32_t m = 0; m < lattice.size(); ++m) {
        bool near = true;
        for (int a = 0; a < 3; ++a) near = near && std::abs(lattice.cell(m)[a] - lattice.cell(n)[a]) <= 1;
        count += near;
      }
      const auto found = lattice.neighbourhood(n);
      ASSERT_EQ(found.size(), count);
      for (const auto& [node, offset] : found)
        for (int a = 0; a < 3; ++a) ASSERT_EQ(lattice.cell(node)[a], lattice.cell(n)[a] + offset[a]);
    }
  }
  EXPECT_GT(added, 0u);
}

}  // namespace
}  // namespace cuboct
