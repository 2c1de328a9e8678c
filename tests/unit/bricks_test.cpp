// SPDX-License-Identifier: MIT
// Which cells a node with a brick serves, and what a plan refuses of bricks.
#include "hw/arch/bricks.h"

#include <gtest/gtest.h>

#include <set>

#include "hw/arch/arch.h"
#include "hw/plan/setup.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

Lattice box_of_cells(const Cell& size, const Cell& period = {}) {
  std::vector<Cell> cells;
  for (int32_t z = 0; z < size[2]; ++z)
    for (int32_t y = 0; y < size[1]; ++y)
      for (int32_t x = 0; x < size[0]; ++x) cells.push_back({x, y, z});
  return Lattice(std::move(cells), period);
}

std::array<uint32_t, kFaces> around(const Bricks& bricks, const Lattice& lattice, uint32_t node) {
  std::array<uint32_t, kFaces> near;
  for (int f = 0; f < kFaces; ++f) near[static_cast<size_t>(f)] = bricks.neighbour(lattice, node, f);
  return near;
}

// 5 x 4 x 1 cells in bricks of 2 x 3 x 1: three columns, the last one cell wide; two rows, the last one high.
TEST(Bricks, CutALatticeFromItsLowestCell) {
  const Lattice lattice = box_of_cells({5, 4, 1});
  const Bricks bricks(lattice, {2, 3, 1});
  ASSERT_EQ(bricks.size(), 6u);
  EXPECT_EQ(bricks.extent(0), (Cell{2, 3, 1}));
  EXPECT_EQ(bricks.extent(2), (Cell{1, 3, 1}));
  EXPECT_EQ(bricks.extent(5), (Cell{1, 1, 1}));
  EXPECT_EQ(bricks.low(lattice, 4), (Cell{2, 3, 0}));
  EXPECT_EQ(around(bricks, lattice, 1), (std::array<uint32_t, kFaces>{0, 2, kNoNode, 4, kNoNode, kNoNode}));
  EXPECT_EQ(bricks.links(lattice, 1), 0b1011);
  for (uint32_t c = 0; c < lattice.size(); ++c) {
    const Cell& at = lattice.cell(c);
    EXPECT_EQ(bricks.node_of(c), static_cast<uint32_t>(at[0] / 2 + 3 * (at[1] / 3)));
    EXPECT_EQ(bricks.local_of(c), static_cast<uint32_t>(at[0] % 2 + 2 * (at[1] % 3)));
    EXPECT_EQ(bricks.cell(bricks.node_of(c), bricks.local_of(c)), c);
  }
  EXPECT_EQ(bricks.cell(5, 1), kNoCell);
}

// A brick of one cell: nodes are cells, links are those of the lattice, and after the exchange a node holds
// what stands around its cell.
TEST(Bricks, OfOneCellAreTheLatticesCells) {
  const Lattice lattice({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 1}}, {3, 0, 0});
  const Bricks bricks(lattice, {1, 1, 1});
  ASSERT_EQ(bricks.size(), lattice.size());
  EXPECT_EQ(bricks.cells(), 1u);
  EXPECT_EQ(bricks.cell_bits(), 0);
  const BrickMap map(lattice, bricks, 3);
  uint32_t apart = 0;
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    EXPECT_EQ(bricks.cell(n, 0), n);
    EXPECT_EQ(bricks.node_of(n), n);
    EXPECT_EQ(bricks.local_of(n), 0u);
    EXPECT_EQ(bricks.low(lattice, n), lattice.cell(n));
    EXPECT_EQ(bricks.extent(n), (Cell{1, 1, 1}));
    for (int f = 0; f < kFaces; ++f) {
      EXPECT_EQ(bricks.neighbour(lattice, n, f), lattice.neighbour(n, f));
      EXPECT_EQ(bricks.links(lattice, n) >> f & 1, lattice.neighbour(n, f) != kNoCell);
    }
    std::vector<uint32_t> expected(map.grid().size(), kNoCell);
    for (const Lattice::Near& near : lattice.neighbourhood(n))
      expected[map.grid().at(near.offset)] = near.cell;
    for (uint32_t place = 0; place < map.grid().size(); ++place) {
      EXPECT_EQ(map.cell(n, place), expected[place]) << n << " " << place;
      apart += expected[place] != kNoCell && expected[place] != n;
    }
  }
  EXPECT_GT(apart, 20u);
}

// A ring of five in bricks of two closes with a brick of one; a ring in one brick is its own neighbour.
TEST(Bricks, CloseRings) {
  const Lattice lattice = box_of_cells({5, 3, 3}, {5, 3, 0});
  const Bricks bricks(lattice, {2, 3, 3});
  ASSERT_EQ(bricks.size(), 3u);
  EXPECT_EQ(around(bricks, lattice, 0), (std::array<uint32_t, kFaces>{2, 1, 0, 0, kNoNode, kNoNode}));
  EXPECT_EQ(around(bricks, lattice, 2), (std::array<uint32_t, kFaces>{1, 0, 2, 2, kNoNode, kNoNode}));
  EXPECT_EQ(bricks.extent(2), (Cell{1, 3, 3}));
}

// Every cell meets itself and each cell around it once, whether it lies within the brick or beyond a face.
TEST(Bricks, AWalkMeetsAllNeighboursOnce) {
  const Cell shape{3, 2, 4};
  const BrickWalk walk(shape, shape, 0b111111, 3);
  const BrickGrid grid(shape);
  std::vector<std::set<std::array<int8_t, 3>>> met(cells_of(shape));
  size_t visits = 0;
  for (const auto& segment : walk.visits)
    for (const BrickWalk::Visit& visit : segment)
      for (uint32_t k = visit.first; k < visit.end; ++k, ++visits) {
        const BrickWalk::Near& near = walk.near[k];
        EXPECT_TRUE(met[visit.own].insert(near.offset).second);
        EXPECT_EQ(near.local >= 0, &segment == &walk.visits[0]);
      }
  EXPECT_EQ(visits, 27 * cells_of(shape));
  for (const auto& offsets : met) EXPECT_EQ(offsets.size(), 27u);
}

TEST(Bricks, LayersHoldWhatDiagonalNeighboursNeed) {
  const Cell shape{3, 2, 4};
  const BrickWalk walk(shape, shape, 0b111111, 3);
  EXPECT_EQ(walk.sent[0].size(), 8u);
  EXPECT_EQ(walk.sent[3].size(), 20u);
  EXPECT_EQ(walk.sent[4].size(), 20u);
  const BrickGrid grid(shape);
  for (int axis = 0; axis < 3; ++axis)
    for (int face = 2 * axis; face < 2 * axis + 2; ++face)
      for (const BrickWalk::Sent& s : walk.sent[static_cast<size_t>(face)]) {
        const int32_t along = face % 2 == 0 ? 0 : shape[axis] - 1;
        EXPECT_EQ(grid.at(grid.of_halo_tag(axis, s.tag, along)), s.grid);
        EXPECT_LT(s.tag, grid.halo_tags(axis));
      }
}

// One cell: 26 halo records, 7 particles. A cube of n^3: (n+2)^3 - n^3 cells around, n^2 per face.
TEST(Bricks, HoldWords) {
  EXPECT_EQ(held_words({1, 1, 1}, 3).halos, 26u);
  EXPECT_EQ(held_words({1, 1, 1}, 3).particles, 7u);
  EXPECT_EQ(held_words({1, 1, 1}, 2).halos, 8u);
  EXPECT_EQ(held_words({4, 4, 4}, 3).halos, 216u - 64u);
  EXPECT_EQ(held_words({4, 4, 4}, 3).particles, 2u * 64u + 6u * 16u);
  EXPECT_EQ(held_words({4, 4, 4}, 3).sums, 64u);
}

std::string refusal(const Features& features, const Cell& brick, int capacity = 16, int lanes = 8) {
  Arch arch;
  arch.brick = brick;
  arch.capacity = capacity;
  arch.filter_lanes = lanes;
  return refused_with([&] { block(features, arch); });
}

TEST(BrickPlans, RefuseWhatDoesNotFit) {
  const Features two{.size = {2, 2, 2}, .margin = 0};
  const Plan plan = block(two).plan;
  ASSERT_EQ(bounding_cells(plan.lattice), 8u);
  EXPECT_EQ(refusal(two, {2, 2, 2}), "accepted");
  EXPECT_EQ(refusal(two, {3, 2, 5}),
            "brick = [3, 2, 5] is larger than the lattice: it has 2 cells along x\n"
            "  hint: set node.brick to at most [2, 2, 2] in the arch file");
  EXPECT_EQ(refusal({.size = {3, 3, 1}, .flat = true}, {2, 2, 2}),
            "brick = [2, 2, 2] is larger than the lattice: it has 1 cell along z\n"
            "  hint: set node.brick to at most [2, 2, 1] in the arch file");
  EXPECT_EQ(refusal(two, {0, 1, 1}), "brick = 0 is out of range: 1 to 512");
  EXPECT_EQ(refusal(two, {9, 9, 9}), "brick = [9, 9, 9] has 729 cells: a node serves at most 512");
  EXPECT_EQ(
      refusal(two, {8, 8, 8}, 256, 1),
      "brick = [8, 8, 8]: 512 cells of 256 slots, met by 1 lanes in 256 passes, are 33554432 visits; a node "
      "makes at most 1048576\n  hint: use a smaller brick or more filter_lanes");
}

std::string of_arch(const std::string& brick) {
  try {
    const Cell c = parse_arch("name = \"a\"\n[node]\nbrick = " + brick + "\n", "a.toml").brick;
    return std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]);
  } catch (const InputError& e) {
    const std::string text = e.what();
    return text.substr(0, text.find('\n'));
  }
}

TEST(BrickPlans, AreReadFromAnArch) {
  EXPECT_EQ(of_arch("[2, 3, 4]"), "2 3 4");
  EXPECT_EQ(of_arch("[2, 3]"), "a.toml:3:9: a brick has three numbers of cells, along x, y and z: got 2");
  EXPECT_EQ(of_arch("[2, -1, 4]"), "a.toml:3:13: 'brick' must be between 1 and 512, not -1");
  EXPECT_EQ(of_arch("[2, 1.5, 4]"), "a.toml:3:13: 'brick' must be a whole number, not a number");
  EXPECT_EQ(of_arch("2"), "a.toml:3:9: 'brick' must be an array, not a whole number");
}

// A plan of single cells is the one that it was before there were bricks; another brick is another plan.
TEST(BrickPlans, HaveTheirOwnHash) {
  const Features f{.size = {2, 2, 2}};
  Arch arch;
  const Plan one = block(f, arch).plan;
  EXPECT_TRUE(one.bricks.one_cell());
  EXPECT_EQ(one.nodes(), one.lattice.size());
  EXPECT_EQ(one.words.migrate_bits, one.words.particle_bits);
  arch.brick = {2, 2, 1};
  const Plan two = block(f, arch).plan;
  EXPECT_NE(one.hash, two.hash);
  EXPECT_LT(two.nodes(), one.nodes());
  // Coordinates lose their signs, 2 bits for each axis but one; layers along z have (2 + 2) x (2 + 2) cells.
  EXPECT_EQ(two.words.halo_bits, one.words.halo_bits - 4 + 4);
  EXPECT_EQ(two.words.migrate_bits, two.words.particle_bits + 2);
}

}  // namespace
}  // namespace cuboct::test
