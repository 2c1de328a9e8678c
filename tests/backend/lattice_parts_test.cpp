// SPDX-License-Identifier: MIT
// The parts of the lattice engine by themselves, each against the shortest program that does the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "emu/lattice/cut.h"
#include "emu/lattice/kernel_rule.h"
#include "emu/lattice/members.h"
#include "emu/lattice/quiet.h"
#include "emu/lattice/search.h"
#include "model/base/fixed_math.h"
#include "tests/support/dice.h"

namespace cuboct::test {
namespace {

// Boxes with gaps between them; axes are rings of 3 to 8 cells, or open with coordinates of any sign.
cuboct::Lattice random_lattice(Dice& dice) {
  Cell period{}, low{}, size{};
  for (int a = 0; a < 3; ++a) {
    if (dice.chance(50)) period[a] = dice.draw(3, 8);
    size[a] = period[a] > 0 ? period[a] : dice.draw(1, 12);
    if (period[a] == 0) low[a] = dice.draw(-70000, 70000);
  }
  std::vector<Cell> cells;
  for (int box = dice.draw(1, 8); box > 0; --box) {
    Cell from, to;
    for (int a = 0; a < 3; ++a) {
      from[a] = low[a] + dice.draw(0, size[a] - 1);
      to[a] = std::min(from[a] + dice.draw(0, 3), low[a] + size[a] - 1);
    }
    for (int z = from[2]; z <= to[2]; ++z)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int x = from[0]; x <= to[0]; ++x) cells.push_back({x, y, z});
  }
  return {cells, period};
}

// A crowd in random places of a lattice.
struct Crowd {
  static constexpr int kFrac = 20;
  Crowd(const cuboct::Lattice& lattice, Dice& dice, uint32_t count) : members(lattice, 1000, count) {
    const uint32_t room = (count + emu::kGroup - 1) / emu::kGroup * emu::kGroup;
    for (auto& x : particles.x) x = emu::PaddedArray<double>(room);
    for (uint32_t p = 0; p < count; ++p) {
      const auto cell = static_cast<uint32_t>(dice.draw(0, static_cast<int>(lattice.size()) - 1));
      EXPECT_TRUE(members.append(cell, p));
      for (int a = 0; a < 3; ++a) {
        // On faces and corners too.
        const auto local =
            dice.chance(10) ? (dice.chance(50) ? 0 : (1 << kFrac) - 1) : static_cast<int>(dice.bits(kFrac));
        particles.x[a][p] = lattice.cell(cell)[a] * std::ldexp(1.0, kFrac) + local;
      }
    }
    particles.cell = members.cells();
    snapshot.position_frac = kFrac;
    snapshot.room = room;
  }
  emu::Particles particles;
  emu::Members members;
  emu::Index index;
  emu::Snapshot snapshot;
};

// (particle, shift) -> distance squared in cells, of all images less than `most` away.
std::map<std::pair<uint32_t, int>, double> brute(const cuboct::Lattice& lattice, const Crowd& crowd,
                                                 uint32_t count, uint32_t i, double most) {
  std::map<std::pair<uint32_t, int>, double> found;
  for (uint32_t j = 0; j < count; ++j)
    for (int s = 0; s < 27; ++s) {
      const std::array<int, 3> image{s % 3 - 1, s / 3 % 3 - 1, s / 9 - 1};
      double r2 = 0;
      bool ring = true;
      for (int a = 0; a < 3; ++a) {
        ring = ring && (image[a] == 0 || lattice.period()[a] > 0);
        const double d = std::ldexp(crowd.particles.x[a][j] - crowd.particles.x[a][i], -Crowd::kFrac) +
                         image[a] * lattice.period()[a];
        r2 += d * d;
      }
      if (ring && r2 < most * most) found[{j, s}] = r2;
    }
  return found;
}

TEST(LatticeSearch, FindsAllWithinReachAndFewBeyond) {
  Dice dice(1);
  size_t near = 0, far = 0, images = 0;
  for (int round = 0; round < 150; ++round) {
    const cuboct::Lattice lattice = random_lattice(dice);
    const emu::Rows rows(lattice);
    const auto count = static_cast<uint32_t>(dice.draw(1, 120));
    Crowd crowd(lattice, dice, count);
    const double reach = dice.chance(30) ? 1.5 : 0.01 * dice.draw(30, 150);
    const bool binned = dice.chance(50);
    emu::Bins bins(lattice, crowd.members, crowd.index, crowd.particles, Crowd::kFrac, 1);
    std::array<std::array<int32_t, 3>, 120> at;
    for (uint32_t p = 0; p < count; ++p)
      for (int a = 0; a < 3; ++a) at[p][a] = emu::coarse(crowd.particles.x[a][p], Crowd::kFrac);
    std::optional<emu::Search> search;
    if (binned) {
      search.emplace(lattice, rows, reach, bins);
    } else {
      bins.release_to(crowd.snapshot);
      search.emplace(lattice, rows, reach, crowd.members, crowd.index, crowd.snapshot);
    }
    for (uint32_t i = 0; i < count; ++i) {
      std::set<std::pair<uint32_t, int>> found;
      for (const auto& hit : search->around(crowd.particles.cell[i], at[i]))
        ASSERT_TRUE(found.insert({hit.particle, hit.shift}).second) << "twice";
      // Places are known to 2^-16 cells per axis.
      const double loose = reach + 4 * std::ldexp(1.0, -16);
      const auto all = brute(lattice, crowd, count, i, loose);
      std::set<uint32_t> around;
      for (const auto& [who, r2] : all) {
        if (r2 <= reach * reach) {
          ASSERT_TRUE(found.count(who)) << "particle " << who.first << " shift " << who.second << " of " << i;
        }
        images += who.second != 13;
        around.insert(who.first);
        ++near;
      }
      for (const auto& who : found) ASSERT_TRUE(all.count(who)) << "too far";
      far += count - around.size();
    }
  }
  EXPECT_GT(near, 20000u);
  EXPECT_GT(far, 20000u);
  EXPECT_GT(images, 5000u);
}

TEST(LatticeRows, GiveTheNodesBetweenTwoCoordinates) {
  Dice dice(2);
  int gaps = 0;
  for (int round = 0; round < 60; ++round) {
    const cuboct::Lattice lattice = random_lattice(dice);
    const emu::Rows rows(lattice);
    for (uint32_t n = 0; n < lattice.size(); ++n) {
      const uint32_t r = rows.row_of(n);
      gaps += !rows.whole(r);
      const int low = lattice.cell(n)[0] + dice.draw(-4, 2), high = low + dice.draw(0, 5);
      std::vector<uint32_t> expected, found;
      for (uint32_t m = 0; m < lattice.size(); ++m) {
        const Cell &c = lattice.cell(m), &own = lattice.cell(n);
        if (c[1] == own[1] && c[2] == own[2] && c[0] >= low && c[0] <= high) expected.push_back(m);
      }
      const auto [begin, end] = rows.cells(r, low, high);
      for (uint32_t m = begin; m < end; ++m) found.push_back(m);
      ASSERT_EQ(found, expected);
      for (int dz = -2; dz <= 2; ++dz)
        for (int dy = -2; dy <= 2; ++dy) {
          // Any cell of the row beside, by find() over all x.
          const uint32_t beside = rows.near(r, dy, dz);
          uint32_t any = kNoCell;
          for (uint32_t m = 0; m < lattice.size() && any == kNoCell; ++m) {
            const Cell &c = lattice.cell(m), &own = lattice.cell(n);
            if (lattice.find({c[0], own[1] + dy, own[2] + dz}) == m) any = m;
          }
          ASSERT_EQ(beside, any == kNoCell ? kNoCell : rows.row_of(any));
        }
    }
  }
  EXPECT_GT(gaps, 100);
}

// What a set of cells holds, by its flags.
std::set<uint32_t> cells_of_set(const emu::CellSet& set, const cuboct::Lattice& lattice) {
  std::set<uint32_t> cells;
  for (uint32_t n = 0; n < lattice.size(); ++n)
    if (set.flags()[n] != 0) cells.insert(n);
  return cells;
}

TEST(LatticeCellSet, DilatesToTheNeighbourhoods) {
  Dice dice(3);
  size_t grown = 0;
  for (int round = 0; round < 400; ++round) {
    const cuboct::Lattice lattice = random_lattice(dice);
    const emu::Rows rows(lattice);
    emu::CellSet set(lattice, rows), out(lattice, rows);
    std::set<uint32_t> expected;
    const int share = dice.draw(0, 30);
    for (uint32_t n = 0; n < lattice.size(); ++n) {
      if (!dice.chance(share)) continue;
      set.flags()[n] = 1;
      for (const auto& near : lattice.neighbourhood(n)) expected.insert(near.cell);
    }
    set.survey(rows);
    const auto before = cells_of_set(set, lattice);
    for (int time = 0; time < 2; ++time) {  // the second time over its own result
      out.dilate(set, lattice, rows);
      ASSERT_EQ(cells_of_set(out, lattice), expected);
      ASSERT_EQ(out.count(rows), expected.size());
    }
    ASSERT_EQ(cells_of_set(set, lattice), before);
    std::set<uint32_t> seen;
    out.for_each(rows, [&](uint32_t n) { seen.insert(n); });
    ASSERT_EQ(seen, expected);
    grown += expected.size() - before.size();
    out.clear(rows);
    ASSERT_TRUE(cells_of_set(out, lattice).empty());
  }
  EXPECT_GT(grown, 5000u);
}

// Two lattices of as many cells and rows, but other rows: what one leaves behind may not reach the other.
TEST(LatticeCellSet, DilatesInTurnOverTwoLattices) {
  const auto rows_of_lengths = [](std::initializer_list<int> lengths) {
    std::vector<Cell> cells;
    int z = 0;
    for (const int length : lengths) {
      for (int x = 0; x < length; ++x) cells.push_back({x, 0, z});
      z += 3;
    }
    return cuboct::Lattice(cells, {});
  };
  const cuboct::Lattice one = rows_of_lengths({8, 2}), two = rows_of_lengths({2, 8});
  ASSERT_EQ(one.size(), two.size());
  const emu::Rows rows_one(one), rows_two(two);
  ASSERT_EQ(rows_one.count(), rows_two.count());
  const auto dilated = [](const cuboct::Lattice& lattice, const emu::Rows& rows, uint32_t cell) {
    emu::CellSet set(lattice, rows), out(lattice, rows);
    set.flags()[cell] = 1;
    set.survey(rows);
    out.dilate(set, lattice, rows);
    return cells_of_set(out, lattice);
  };
  EXPECT_EQ(dilated(one, rows_one, 6), (std::set<uint32_t>{5, 6, 7}));
  EXPECT_EQ(dilated(two, rows_two, 3), (std::set<uint32_t>{2, 3, 4}));
  EXPECT_EQ(dilated(one, rows_one, 0), (std::set<uint32_t>{0, 1}));
}

TEST(LatticeMembers, KeepTheOrderOfSlotsAndRefuseInTheOrderOfAxes) {
  // 0 1 2 along x, capacity 3.
  const cuboct::Lattice lattice({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {});
  const auto ids = [](const emu::Members& members, uint32_t cell) {
    std::vector<uint32_t> list;
    members.for_each(cell, [&](uint32_t id) { list.push_back(id); });
    return list;
  };
  const auto filled = [&] {
    emu::Members members(lattice, 3, 7);
    for (const uint32_t id : {5u, 0u}) EXPECT_TRUE(members.append(0, id));
    for (const uint32_t id : {2u, 1u, 6u}) EXPECT_TRUE(members.append(1, id));
    for (const uint32_t id : {4u, 3u}) EXPECT_TRUE(members.append(2, id));
    return members;
  };
  std::vector<emu::Leaving> leaving;
  {
    // The head and the tail of cell 1 leave, one comes from above, one from below: below stands first.
    emu::Members members = filled();
    const std::vector<emu::Crossing> crossings{
        {3, {-1, 0, 0}}, {6, {1, 0, 0}}, {0, {1, 0, 0}}, {2, {-1, 0, 0}}};
    EXPECT_TRUE(members.migrate(crossings, leaving).empty());
    EXPECT_EQ(ids(members, 0), (std::vector<uint32_t>{5, 2}));
    EXPECT_EQ(ids(members, 1), (std::vector<uint32_t>{1, 0, 3}));
    EXPECT_EQ(ids(members, 2), (std::vector<uint32_t>{4, 6}));
    EXPECT_EQ(members.cells()[6], 2u);
    ASSERT_EQ(leaving.size(), 4u);
    EXPECT_EQ(std::tuple(leaving[0].cell, leaving[0].slot), std::tuple(0u, 1u));
    EXPECT_EQ(std::tuple(leaving[1].cell, leaving[1].slot), std::tuple(1u, 0u));
    EXPECT_EQ(std::tuple(leaving[2].cell, leaving[2].slot), std::tuple(1u, 2u));
    EXPECT_EQ(std::tuple(leaving[3].cell, leaving[3].slot), std::tuple(2u, 1u));
  }
  {
    // A full cell takes as many as leave it in the same axis, and refuses one more: the last to come.
    emu::Members members = filled();
    const std::vector<emu::Crossing> crossings{{0, {1, 0, 0}}, {2, {1, 0, 0}}, {3, {-1, 0, 0}}};
    const auto refused = members.migrate(crossings, leaving);
    ASSERT_EQ(refused.size(), 1u);
    EXPECT_EQ(refused[0].fault, Fault::full_x);
    EXPECT_EQ(refused[0].particle, 3u);
    EXPECT_EQ(refused[0].cell, 1u);
  }
  {
    // Who finds no cell along x ends the step there, though another would find none along z.
    emu::Members members = filled();
    const std::vector<emu::Crossing> crossings{{4, {0, 0, 1}}, {3, {1, 0, 0}}};
    const auto refused = members.migrate(crossings, leaving);
    ASSERT_EQ(refused.size(), 1u);
    EXPECT_EQ(refused[0].fault, Fault::left_x);
    EXPECT_EQ(refused[0].particle, 3u);
    EXPECT_EQ(refused[0].cell, 2u);
  }
  EXPECT_FALSE([&] {
    emu::Members members = filled();
    return members.append(1, 3);
  }());
}

TEST(LatticeCut, GivesEachRankItsShareToWithinAPlane) {
  Dice dice(4);
  for (int round = 0; round < 60; ++round) {
    std::vector<Cell> cells;
    const Cell size{dice.draw(8, 20), dice.draw(8, 20), dice.draw(8, 20)};
    for (int z = 0; z < size[2]; ++z)
      for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x) cells.push_back({x, y, z});
    const cuboct::Lattice lattice(cells, {});
    std::vector<uint16_t> weight(lattice.size());
    for (auto& w : weight) w = static_cast<uint16_t>(dice.draw(0, 9));
    const int ranks = dice.draw(2, 8);
    for (int axis = 0; axis < 3; ++axis) {
      const auto owner = emu::cut_cells(lattice, weight, ranks, std::string(1, "xyz"[axis]));
      std::vector<double> held(static_cast<size_t>(ranks)), plane(static_cast<size_t>(size[axis]));
      double total = 0;
      std::map<int, int> rank_of_plane;
      for (uint32_t n = 0; n < lattice.size(); ++n) {
        ASSERT_LT(owner[n], ranks);
        held[owner[n]] += weight[n];
        plane[static_cast<size_t>(lattice.cell(n)[axis])] += weight[n];
        total += weight[n];
        const auto [at, fresh] = rank_of_plane.emplace(lattice.cell(n)[axis], owner[n]);
        ASSERT_EQ(at->second, owner[n]) << "a plane in two parts";
      }
      int last = 0;
      for (const auto& [at, rank] : rank_of_plane) {
        ASSERT_GE(rank, last);
        last = rank;
      }
      // Each of log2(ranks) cuts errs by at most half a plane.
      const double heaviest = *std::max_element(plane.begin(), plane.end());
      for (const double h : held) ASSERT_NEAR(h, total / ranks, 1.5 * heaviest) << ranks << " ranks";
    }
    const auto bricks = emu::cut_cells(lattice, weight, ranks, "bricks");
    std::vector<double> held(static_cast<size_t>(ranks));
    double total = 0;
    for (uint32_t n = 0; n < lattice.size(); ++n) {
      ASSERT_LT(bricks[n], ranks);
      held[bricks[n]] += weight[n];
      total += weight[n];
    }
    for (const double h : held) {
      ASSERT_GT(h, 0.5 * total / ranks);
      ASSERT_LT(h, 1.6 * total / ranks);
    }
  }
}

TEST(LatticeCut, GivesFewNodesToManyRanks) {
  const cuboct::Lattice one({{5, -3, 7}}, {});
  for (const char* how : {"bricks", "x", "y", "z"}) {
    EXPECT_LT(emu::cut_cells(one, {4}, 8, how).at(0), 8);
    EXPECT_LT(emu::cut_cells(one, {0}, 8, how).at(0), 8);
    EXPECT_TRUE(emu::cut_cells(cuboct::Lattice({}, {}), {}, 8, how).empty());
  }
  const cuboct::Lattice two({{0, 0, 0}, {1, 0, 0}}, {});
  const auto owner = emu::cut_cells(two, {3, 3}, 2, "bricks");
  EXPECT_EQ(owner, (std::vector<uint16_t>{0, 1}));
}

// kernel_rule.h: one fused multiply-add beside kMagic is b + round_odd(a, s), for all that fits.
TEST(LatticeRounding, FusedMultiplyAddRoundsAsTheContractSays) {
  Dice dice(5);
  size_t halves = 0;
  for (int s = 0; s <= 51; ++s) {
    const double factor = emu::rounding_factor(s);
    const auto check = [&](int64_t a, int64_t b) {
      const int64_t expected = b + round_odd(a, s);
      if (std::abs(expected) >= int64_t{1} << 51) return;
      const double found =
          std::fma(static_cast<double>(a), factor, emu::kMagic + static_cast<double>(b)) - emu::kMagic;
      ASSERT_EQ(static_cast<int64_t>(found), expected) << a << " / 2^" << s << " + " << b;
    };
    const int64_t most = (int64_t{1} << 52) - 1, unit = int64_t{1} << s, half = unit / 2;
    for (int k = 0; k < 3000; ++k) {
      auto a = static_cast<int64_t>(dice.bits(dice.draw(0, 52)));
      if (k % 3 == 0 && s > 0) {  // a half, or one beside
        a = std::min(most, a / unit * unit + half + dice.draw(-1, 1));
        halves += a % unit == half;
      }
      if (k % 97 == 0) a = most - dice.draw(0, 2);
      const auto b = static_cast<int64_t>(dice.bits(dice.draw(0, 50))) * (dice.chance(50) ? 1 : -1);
      check(a, b);
      check(-a, b);
      if (HasFatalFailure()) return;
    }
    for (const int64_t a : {int64_t{0}, int64_t{1}, half, half - 1, half + 1, unit, most, most - half})
      for (const int64_t b : {int64_t{0}, int64_t{-1}, (int64_t{1} << 50), -(int64_t{1} << 50)})
        if (a >= 0 && a <= most) check(a, b), check(-a, b);
  }
  EXPECT_GT(halves, 10000u);
}

}  // namespace
}  // namespace cuboct::test
