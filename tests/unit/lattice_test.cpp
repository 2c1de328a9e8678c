// SPDX-License-Identifier: MIT
#include "model/contract/lattice.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>

#include "model/base/error.h"

namespace cuboct {
namespace {

std::vector<Cell> cells_of_box(int nx, int ny, int nz) {
  std::vector<Cell> cells;
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) cells.push_back({x, y, z});
  return cells;
}

TEST(Lattice, BoxHasItsLinksInOrder) {
  const Lattice lattice(cells_of_box(3, 2, 1), {0, 0, 0});
  ASSERT_EQ(lattice.size(), 6u);
  EXPECT_EQ(lattice.cell(1), (Cell{1, 0, 0}));  // (z, y, x) order
  EXPECT_EQ(lattice.cell(3), (Cell{0, 1, 0}));
  EXPECT_EQ(lattice.neighbour(1, 0), 0u);
  EXPECT_EQ(lattice.neighbour(1, 1), 2u);
  EXPECT_EQ(lattice.neighbour(1, 2), kNoCell);
  EXPECT_EQ(lattice.neighbour(1, 3), 4u);
  EXPECT_EQ(lattice.neighbour(1, 5), kNoCell);
  EXPECT_EQ(lattice.neighbourhood(1).size(), 6u);
  EXPECT_EQ(lattice.neighbourhood(0).size(), 4u);
}

TEST(Lattice, RingsWrap) {
  const Lattice lattice(cells_of_box(3, 4, 5), {3, 4, 5});
  EXPECT_EQ(lattice.neighbour(0, 0), 2u);
  EXPECT_EQ(lattice.find({-1, 4, 5}), 2u);
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    const auto near = lattice.neighbourhood(n);
    ASSERT_EQ(near.size(), 27u);
    for (size_t i = 0; i < 27; ++i)
      for (size_t j = i + 1; j < 27; ++j) ASSERT_NE(near[i].cell, near[j].cell);
  }
}

// Two cells that touch at a corner need the cells on the way x, then y, then z, in both directions.
TEST(Lattice, ClosesTheWayAroundACorner) {
  const Lattice lattice({{0, 0, 0}, {1, 1, 1}}, {0, 0, 0});
  for (const Cell& way : {Cell{1, 0, 0}, Cell{1, 1, 0}, Cell{0, 1, 1}, Cell{0, 0, 1}})
    EXPECT_NE(lattice.find(way), kNoCell);
  const Lattice apart({{0, 0, 0}, {2, 0, 0}}, {0, 0, 0});
  EXPECT_EQ(apart.size(), 2u);
}

// From any cell, its neighbourhood by links is all cells of the set around it: brute force as the oracle.
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
      for (const auto& [cell, offset] : found)
        for (int a = 0; a < 3; ++a) ASSERT_EQ(lattice.cell(cell)[a], lattice.cell(n)[a] + offset[a]);
    }
  }
  EXPECT_GT(added, 0u);
}

struct Order {
  bool operator()(const Cell& a, const Cell& b) const {
    return std::tie(a[2], a[1], a[0]) < std::tie(b[2], b[1], b[0]);
  }
};
using Cells = std::set<Cell, Order>;

Cell wrapped(Cell c, const Cell& period) {
  for (int a = 0; a < 3; ++a)
    if (period[a] > 0) c[a] = ((c[a] % period[a]) + period[a]) % period[a];
  return c;
}

// A diagonal takes all cells of the cube around it, whose number is bounded before it is made.
TEST(Lattice, ADiagonalFillsItsCubeOrIsRefused) {
  const auto diagonal = [](int length) {
    std::vector<Cell> cells;
    for (int k = 0; k < length; ++k) cells.push_back({k, k, k});
    return cells;
  };
  EXPECT_EQ(Lattice(diagonal(30), {}).size(), 27000u);
  try {
    Lattice(diagonal(4000), {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "more than 2000000 cells are needed around the 4000 that particles reach: a body that slants "
        "takes all cells of the box around it\n  hint: turn its length along an axis, or a larger "
        "pitch");
  }
}

// The definition: whenever two diagonal neighbours are in the set, so are the cells on the way by x, y, z.
Cells closed(const std::vector<Cell>& cells, const Cell& period) {
  Cells set;
  for (const Cell& c : cells) set.insert(wrapped(c, period));
  for (size_t before = 0; before != set.size();) {
    before = set.size();
    for (const Cell& c : std::vector<Cell>(set.begin(), set.end()))
      for (int k = 0; k < 27; ++k) {
        const Cell d{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        if (!set.contains(wrapped({c[0] + d[0], c[1] + d[1], c[2] + d[2]}, period))) continue;
        set.insert(wrapped({c[0] + d[0], c[1], c[2]}, period));
        set.insert(wrapped({c[0] + d[0], c[1] + d[1], c[2]}, period));
      }
  }
  return set;
}

// Cells, order, links and find() against that definition, on sparse and dense sets with and without rings.
TEST(Lattice, IsTheClosureOfItsCells) {
  std::mt19937_64 random(11);
  size_t added = 0, rings = 0;
  for (int round = 0; round < 300; ++round) {
    Cell period{};
    for (int a = 0; a < 3; ++a)
      if (random() % 3 == 0) period[a] = 3 + static_cast<int>(random() % 6);
    rings += period != Cell{};
    const int spread = 4 + static_cast<int>(random() % 9);
    std::vector<Cell> cells(1 + random() % 60);
    for (Cell& c : cells)
      for (int a = 0; a < 3; ++a) c[a] = static_cast<int>(random() % spread) - 3;
    const Cells expected = closed(cells, period);
    std::set<Cell, Order> given;
    for (const Cell& c : cells) given.insert(wrapped(c, period));
    added += expected.size() - given.size();
    const Lattice lattice(cells, period);
    ASSERT_EQ(lattice.size(), expected.size());
    uint32_t n = 0;
    for (const Cell& c : expected) ASSERT_EQ(lattice.cell(n++), c);
    const auto index = [&](const Cell& c) {
      const auto it = expected.find(wrapped(c, period));
      return it == expected.end() ? kNoCell : static_cast<uint32_t>(std::distance(expected.begin(), it));
    };
    for (n = 0; n < lattice.size(); ++n)
      for (int face = 0; face < kFaces; ++face) {
        Cell c = lattice.cell(n);
        c[face / 2] += face % 2 ? 1 : -1;
        ASSERT_EQ(lattice.neighbour(n, face), index(c));
      }
    for (int k = 0; k < 200; ++k) {
      const Cell c{static_cast<int>(random() % 20) - 8, static_cast<int>(random() % 20) - 8,
                   static_cast<int>(random() % 20) - 8};
      ASSERT_EQ(lattice.find(c), index(c));
    }
  }
  EXPECT_GT(added, 1000u);
  EXPECT_GT(rings, 100u);
}

// Beside a row of cells stands one at its end: each cell on the way along the row asks for the next.
TEST(Lattice, ClosesANeedleWithoutARoundForAllCells) {
  constexpr int kLength = 100'000;
  std::vector<Cell> cells{{0, 0, 0}};
  for (int x = 0; x < kLength; ++x) cells.push_back({x, 1, 0});
  const Lattice lattice(cells, {0, 0, 0});
  ASSERT_EQ(lattice.size(), 2U * kLength);
  EXPECT_EQ(lattice.cell(kLength - 1), (Cell{kLength - 1, 0, 0}));
  EXPECT_EQ(lattice.cell(kLength), (Cell{0, 1, 0}));
  EXPECT_EQ(lattice.neighbour(kLength - 1, 3), 2U * kLength - 1);
}

// A lattice over the box that holds both would have 10^18 cells.
TEST(Lattice, TwoBodiesAMillionCellsApart) {
  std::vector<Cell> cells = cells_of_box(20, 20, 20);
  for (const Cell& c : cells_of_box(20, 20, 20))
    cells.push_back({c[0] + 1'000'000, c[1] - 1'000'000, c[2] + 1'000'000});
  cells.push_back({500'000, 0, 0});
  const Lattice lattice(cells, {0, 0, 0});
  ASSERT_EQ(lattice.size(), 16'001u);
  EXPECT_EQ(lattice.cell(0), (Cell{0, 0, 0}));
  EXPECT_EQ(lattice.find({1'000'019, -999'981, 1'000'019}), 16'000u);
  EXPECT_EQ(lattice.find({500'000, 0, 0}), 20u);  // in the row of the first body
  EXPECT_EQ(lattice.find({499'999, 0, 0}), kNoCell);
  EXPECT_EQ(lattice.neighbour(20, 0), kNoCell);
  EXPECT_EQ(lattice.neighbourhood(20).size(), 1u);
}

TEST(Lattice, MayBeEmpty) {
  const Lattice lattice({}, {0, 0, 0});
  EXPECT_EQ(lattice.size(), 0u);
  EXPECT_EQ(lattice.find({0, 0, 0}), kNoCell);
  EXPECT_EQ(Lattice().find({0, 0, 0}), kNoCell);
}

}  // namespace
}  // namespace cuboct
