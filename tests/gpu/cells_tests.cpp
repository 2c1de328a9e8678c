// SPDX-License-Identifier: MIT
// Where the gpu engines store particles, and what they refuse before they ask for memory.
#include "emu/gpu/cells.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "emu/gpu/grid_view.h"
#include "emu/gpu/messages.h"
#include "model/base/error.h"
#include "tests/support/dice.h"
#include "tests/support/refused_with.h"

namespace cuboct::gpu {
namespace {

std::array<std::vector<uint64_t>, 3> even(const Geometry& g) {
  std::array<std::vector<uint64_t>, 3> per_plane;
  for (int a = 0; a < 3; ++a) per_plane[a].assign(static_cast<size_t>(g.total[a]), 5);
  return per_plane;
}

GridView view_of(const Cells& cells, const SlabCells& slab) {
  const Geometry& g = cells.geometry;
  GridView view{};
  for (int a = 0; a < 3; ++a) {
    view.low[a] = g.low[a];
    view.total[a] = view.local[a] = g.total[a];
    view.wraps[a] = g.wraps[a];
  }
  view.axis = cells.axis;
  view.local[cells.axis] = slab.local_planes;
  view.local_first = slab.local_first;
  view.folds = g.folds;
  view.rank = slab.rank.data();
  return view;
}

// The cell of each rank; a rank that comes twice, or not at all, is a failure.
std::vector<Cell> by_rank(const Cells& cells, const SlabCells& slab) {
  std::vector<Cell> of(slab.ranks, Cell{-1, -1, -1});
  std::vector<int> seen(slab.ranks, 0);
  Cell size = cells.geometry.total;
  size[cells.axis] = slab.local_planes;
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x) {
        const uint32_t rank = slab.rank[(static_cast<size_t>(z) * size[1] + y) * size[0] + x];
        if (rank == kNoCell) continue;
        EXPECT_LT(rank, slab.ranks);
        if (rank >= slab.ranks) return of;
        Cell c{x, y, z};
        const int total = cells.geometry.total[cells.axis];
        c[cells.axis] = (c[cells.axis] + slab.local_first + total) % total;
        of[rank] = c;
        ++seen[rank];
      }
  for (const int times : seen) EXPECT_EQ(times, 1);
  return of;
}

// What machine.h counts on, checked cell by cell for boxes of all kinds.
TEST(GpuCells, BordersAndCopiesAreTheSameCellsInTheSameOrder) {
  int rings = 0, sparse = 0, cuts = 0;
  std::array<int, 3> axes{};
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    test::Dice dice(seed);
    Geometry g;
    g.reach = dice.draw(1, 2);
    g.folds = dice.chance(30);
    for (int a = 0; a < 3; ++a) {
      g.total[a] = dice.draw(1, 7);
      g.low[a] = dice.draw(-9, 9);
      g.wraps[a] = dice.chance(30);
    }
    const int along = dice.draw(0, 2), slabs = dice.draw(1, 4);
    g.total[along] = std::max({2 * g.reach * slabs + dice.draw(0, 9), g.total[0], g.total[1], g.total[2]});
    Lattice lattice;
    if (!g.folds && dice.chance(50) && !(g.wraps[0] || g.wraps[1] || g.wraps[2])) {
      std::vector<Cell> some;
      for (int x = 0; x < g.total[0]; ++x)
        for (int y = 0; y < g.total[1]; ++y)
          for (int z = 0; z < g.total[2]; ++z)
            if (dice.chance(40)) some.push_back({x + g.low[0], y + g.low[1], z + g.low[2]});
      if (some.empty()) continue;
      lattice = Lattice(some, {0, 0, 0});
      g.lattice = &lattice;
      ++sparse;
    }
    std::array<std::vector<uint64_t>, 3> per_plane;
    for (int a = 0; a < 3; ++a)
      for (int p = 0; p < g.total[a]; ++p) per_plane[a].push_back(static_cast<uint64_t>(dice.draw(0, 100)));
    const Cells cells = make_cells(g, per_plane, slabs);
    ++axes[static_cast<size_t>(cells.axis)];
    EXPECT_EQ(g.total[cells.axis], std::max({g.total[0], g.total[1], g.total[2]}));
    const bool ring = g.folds || g.wraps[cells.axis];
    rings += ring;
    ASSERT_EQ(cells.slabs.size(), static_cast<size_t>(slabs));
    int next = 0;
    for (int s = 0; s < slabs; ++s) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", slab " + std::to_string(s));
      const SlabCells& slab = cells.slabs[static_cast<size_t>(s)];
      ASSERT_EQ(slab.first, next);
      ASSERT_GE(slab.planes, slabs > 1 ? 2 * g.reach : 1);
      next += slab.planes;
      for (int p = slab.first; p < next; ++p) ASSERT_EQ(cells.owner(p), s);
      const std::vector<Cell> mine = by_rank(cells, slab);
      // Own ranks are of own planes, the borders at their ends.
      for (uint32_t r = 0; r < slab.ranks; ++r) {
        const int plane = mine[r][cells.axis];
        ASSERT_EQ(r < slab.own_end, cells.owner(plane) == s) << "rank " << r;
        const int in = plane - slab.first;
        if (r < slab.own_end) {
          ASSERT_EQ(r < slab.low_end, slab.lower >= 0 && in < g.reach) << "rank " << r;
          ASSERT_EQ(r >= slab.inner_end, slab.upper >= 0 && in >= slab.planes - g.reach) << "rank " << r;
        }
        Cell there = mine[r];
        for (int a = 0; a < 3; ++a) there[a] += g.low[a];
        ASSERT_EQ(view_of(cells, slab).find({there[0], there[1], there[2]}), r);
        ASSERT_TRUE(!g.lattice || lattice.find(there) != kNoCell);
        for (int a = 0; a < 3; ++a) {
          int32_t image[3] = {there[0], there[1], there[2]};
          image[a] += g.total[a] * (dice.chance(50) ? 1 : -1);
          ASSERT_EQ(view_of(cells, slab).find(image), g.wraps[a] || g.folds ? r : kNoCell);
        }
      }
      if (slabs == 1) continue;
      ++cuts;
      ASSERT_EQ(slab.lower, s > 0 ? s - 1 : ring ? slabs - 1 : -1);
      ASSERT_EQ(slab.upper, s + 1 < slabs ? s + 1 : ring ? 0 : -1);
      const auto part = [](const std::vector<Cell>& all, uint32_t begin, uint32_t end) {
        return std::vector<Cell>(all.begin() + begin, all.begin() + end);
      };
      if (slab.lower >= 0) {
        const SlabCells& other = cells.slabs[static_cast<size_t>(slab.lower)];
        ASSERT_EQ(part(mine, slab.own_end, slab.lower_copy_end),
                  part(by_rank(cells, other), other.inner_end, other.own_end));
      }
      if (slab.upper >= 0) {
        const SlabCells& other = cells.slabs[static_cast<size_t>(slab.upper)];
        ASSERT_EQ(part(mine, slab.lower_copy_end, slab.ranks), part(by_rank(cells, other), 0, other.low_end));
      }
    }
    ASSERT_EQ(next, g.total[cells.axis]);
    EXPECT_EQ(cells.owner(next), -1);
  }
  EXPECT_GT(rings, 50);
  EXPECT_GT(sparse, 20);
  EXPECT_GT(cuts, 300);
  for (const int times : axes) EXPECT_GT(times, 50);
}

// By hand: twelve planes, all particles in the first and the last two.
TEST(GpuCells, SlabsShareParticlesNotPlanes) {
  Geometry g;
  g.total = {2, 12, 3};
  g.reach = 1;
  auto per_plane = even(g);
  per_plane[1] = {600, 0, 0, 0, 0, 0, 0, 0, 0, 0, 100, 500};
  const auto planes = [&](int slabs) {
    std::vector<int> of;
    for (const SlabCells& slab : make_cells(g, per_plane, slabs).slabs) of.push_back(slab.planes);
    return of;
  };
  EXPECT_EQ(planes(1), (std::vector<int>{12}));
  EXPECT_EQ(planes(2).front() + planes(2).back(), 12);
  EXPECT_LE(planes(2).front(), 10);
  per_plane[1].assign(12, 7);
  EXPECT_EQ(planes(2), (std::vector<int>{6, 6}));
  EXPECT_EQ(planes(3), (std::vector<int>{4, 4, 4}));
  EXPECT_EQ(planes(6), (std::vector<int>{2, 2, 2, 2, 2, 2}));
  per_plane[1] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 90, 90};
  EXPECT_EQ(planes(2), (std::vector<int>{10, 2}));
}

TEST(GpuCells, RefusesMoreSlabsThanThereArePlanesFor) {
  Geometry g;
  g.total = {3, 7, 4};
  g.reach = 2;
  EXPECT_EQ(refused_with([&] { make_cells(g, even(g), 2); }),
            "2 slabs of 4 planes of cells or more: the scene has 7 along its longest axis\n"
            "  hint: use fewer devices");
  g.total[1] = 8;
  EXPECT_EQ(refused_with([&] { make_cells(g, even(g), 2); }), "accepted");
}

TEST(GpuEntries, TellPlaceAndCellApart) {
  std::set<uint32_t> codes;
  for (int dz = -2; dz <= 2; ++dz)
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) {
        const uint32_t place = kPlaceMask<2> - static_cast<uint32_t>(dx + 2);
        const uint32_t entry = Entry<2>::of(place, dx, dy, dz);
        int away[3];
        Entry<2>::away(entry, away);
        EXPECT_EQ(entry & kPlaceMask<2>, place);
        EXPECT_EQ((std::array<int, 3>{away[0], away[1], away[2]}), (std::array<int, 3>{dx, dy, dz}));
        EXPECT_TRUE(codes.insert(entry).second);
        if (std::max({std::abs(dx), std::abs(dy), std::abs(dz)}) > 1) continue;
        const uint32_t near = Entry<1>::of(kPlaceMask<1>, dx, dy, dz);
        Entry<1>::away(near, away);
        EXPECT_EQ(near & kPlaceMask<1>, kPlaceMask<1>);
        EXPECT_EQ((std::array<int, 3>{away[0], away[1], away[2]}), (std::array<int, 3>{dx, dy, dz}));
      }
  EXPECT_EQ(codes.size(), 125u);
}

TEST(GpuRefusals, OfDevicesAndBlocks) {
  ASSERT_EQ(find_devices().size(), 8u);
  const auto text = [](std::vector<int> devices, int block) {
    return refused_with([&] { require_devices({devices, block}); });
  };
  EXPECT_EQ(text({0, 7, 0}, 128), "accepted");
  EXPECT_EQ(text({0}, 32), "accepted");
  EXPECT_EQ(text({0}, 256), "accepted");
  EXPECT_EQ(text({0, 8}, 128), "there is no CUDA device 8\n  hint: this machine has 8: 0 to 7");
  EXPECT_EQ(text({-1}, 128), "there is no CUDA device -1\n  hint: this machine has 8: 0 to 7");
  for (const int block : {0, 16, 100, 288, -32})
    EXPECT_EQ(text({0}, block),
              "a block of " + std::to_string(block) + " threads\n  hint: a multiple of 32 from 32 to 256");
  EXPECT_EQ(text({}, 128), "0 slabs\n  hint: from 1 to 16");
  EXPECT_EQ(text(std::vector<int>(17, 0), 128), "17 slabs\n  hint: from 1 to 16");
}

TEST(GpuRefusals, OfTablesThatNoBlockHolds) {
  const auto text = [](uint64_t bytes) { return refused_with([&] { require_tables({{2}, 128}, bytes); }); };
  EXPECT_EQ(text(232448), "accepted");
  EXPECT_EQ(text(232449),
            "the rule's tables take 232449 bytes, and a block of device 2 (host) holds 232448\n"
            "  hint: fewer of the arch's table.index_bits");
}

// The host's free memory changes from call to call: words and proportions are what is compared.
TEST(GpuRefusals, OfMemoryBeforeItIsAskedFor) {
  const auto text = [](std::vector<int> devices, uint64_t particles, uint64_t cells) {
    return refused_with([&] { require_memory({devices, 128}, particles, cells, 200); });
  };
  EXPECT_EQ(text({0}, 1000, 1000), "accepted");
  const std::regex words(
      R"((\d+) particles need (\d+\.\d) GiB on device (\d) \(host\), which has (\d+\.\d) GiB free\n)"
      R"(  hint: about (\d+) particles fit, or use more devices)");
  std::smatch one, two;
  const std::string of_one = text({3}, 1'000'000'000'000, 0), of_two = text({3, 4}, 1'000'000'000'000, 0);
  ASSERT_TRUE(std::regex_match(of_one, one, words)) << of_one;
  ASSERT_TRUE(std::regex_match(of_two, two, words)) << of_two;
  EXPECT_EQ(one[1], "1000000000000");
  EXPECT_EQ(one[2], "204891.0");  // 1.1 * 200e12 / 2^30
  EXPECT_EQ(one[3], "3");
  EXPECT_EQ(two[2], "102445.5");
  const double free = std::stod(one[4]) * 0x1p30, fit = std::stod(one[5]);
  EXPECT_NEAR(fit * 220, free, 0.1e9);
  // Both parts of a scene on one device need what one does.
  const std::string shared = text({3, 3}, 1'000'000'000'000, 0);
  ASSERT_TRUE(std::regex_match(shared, two, words)) << shared;
  EXPECT_EQ(two[2], one[2]);
  const std::string empty = text({0}, 10, 1'000'000'000'000);
  ASSERT_TRUE(std::regex_match(empty, one, words)) << empty;
  EXPECT_EQ(one[2], "3725.3");  // 4e12 / 2^30
}

}  // namespace
}  // namespace cuboct::gpu
