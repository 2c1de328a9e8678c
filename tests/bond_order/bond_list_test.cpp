// SPDX-License-Identifier: MIT
// The list of neighbours: brute force beside it, when it is made anew, what it refuses.
#include <gtest/gtest.h>

#include <random>

#include "model/atoms/bond_order/atom_cell.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

// Neighbours by brute force over images, in boxes shorter than the cutoff too.
TEST(BondList, HasEachPairWithinTheReachOnce) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  size_t pairs = 0;
  for (int trial = 0; trial < 40; ++trial) {
    AtomCell cell;
    cell.box.edges = 4 * Mat3::Identity();
    for (int k = 0; k < 9; ++k) cell.box.edges(k % 3, k / 3) += number(random);
    for (int a = 0; a < 3; ++a) cell.box.periodic[a] = random() % 3 != 0;
    for (int k = 0; k < 1 + trial; ++k)
      cell.x.emplace_back(8 * Vec3(number(random), number(random), number(random)));
    BondList list(2.0 + trial % 5, 0.25, bond_lanes());
    list.update(cell.box, cell.x);
    const double reach = 2.25 + trial % 5;
    std::vector<size_t> counted(cell.x.size(), 0), listed(cell.x.size(), 0);
    const auto turns = [&](int axis) { return cell.box.periodic[axis] ? 12 : 0; };
    for (size_t i = 0; i < cell.x.size(); ++i)
      for (size_t j = 0; j < cell.x.size(); ++j)
        for (int a = -turns(0); a <= turns(0); ++a)
          for (int b = -turns(1); b <= turns(1); ++b)
            for (int c = -turns(2); c <= turns(2); ++c) {
              const double r = (cell.x[j] + cell.box.edges * Vec3(a, b, c) - cell.x[i]).norm();
              if (r > 0 && r < reach) ++counted[i];
            }
    for (size_t g = 0; g < list.groups(); ++g)
      for (size_t row = list.first_row()[g]; row < list.first_row()[g + 1]; ++row)
        for (size_t lane = 0; lane < list.lanes(); ++lane) {
          const size_t i = g * list.lanes() + lane, slot = row * list.lanes() + lane,
                       place = list.entry()[slot] / 4;
          if (place == i) continue;
          ASSERT_EQ(list.reverse()[list.reverse()[slot] / 4], 4 * slot);
          ++listed[i];
        }
    for (size_t i = 0; i < cell.x.size(); ++i) pairs += counted[i];
    EXPECT_EQ(counted, listed) << "trial " << trial;
  }
  EXPECT_GT(pairs, 10000u);
}

// The list is kept while no missing pair can be near, also where the box carries its atoms.
TEST(BondList, IsMadeAnewWhenAPairMayHaveComeNear) {
  const AtomCell cell = diamond_block(5.43, 2, 2, 2);
  BondList list(3.2, 0.4, bond_lanes());
  EXPECT_TRUE(list.update(cell.box, cell.x));
  EXPECT_FALSE(list.update(cell.box, cell.x));
  AtomCell moved = cell;
  moved.x[5][0] += 0.19;
  EXPECT_FALSE(list.update(moved.box, moved.x));
  moved.x[5][0] += 0.02;
  EXPECT_TRUE(list.update(moved.box, moved.x));
  EXPECT_TRUE(list.update(cell.box, cell.x));
  Mat3 strain = Mat3::Zero();
  strain(0, 0) = -0.10;  // 3.6 to 3.24 at the least, no atom moved besides
  EXPECT_FALSE(list.update(strained(cell, strain).box, strained(cell, strain).x));
  strain(0, 0) = -0.12;
  EXPECT_TRUE(list.update(strained(cell, strain).box, strained(cell, strain).x));
}

TEST(BondList, RefusesWhatIsNoPosition) {
  AtomCell cell = diamond_block(5.43, 2, 2, 2);
  BondList list(3.2, 0.4, bond_lanes());
  const auto said = [&] { return refused_with<std::runtime_error>([&] { list.update(cell.box, cell.x); }); };
  EXPECT_EQ(said(), "accepted");
  cell.x[9][1] = std::nan("");
  EXPECT_EQ(said(), "the position of atom 9 is not finite");
  cell.x[9] = cell.x[3] + cell.box.edges.col(1);
  EXPECT_EQ(said(), "atoms 3 and 9 are at one point");
}

}  // namespace
}  // namespace cuboct
