// SPDX-License-Identifier: MIT
// The vector filter against model/contract/fixed_rule.h: every vector unit of this machine, every width of
// the formats, particles on the planes of the test.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cmath>
#include <random>

#include "emu/timing/hits.h"
#include "model/contract/lattice.h"

namespace cuboct::test {
namespace {

struct Stimuli {
  uint64_t items = 0, entries = 0, on_plane = 0, next_to_plane = 0, several_passes = 0, wide = 0;
};

FixedRule rule_of(int p, int d, int b, double cutoff) {
  FixedRule rule;
  rule.widths.position_frac = p;
  rule.widths.difference_frac = d;
  rule.difference_shift = p - d;
  rule.cutoff2 = static_cast<uint64_t>(cutoff * cutoff * std::ldexp(1.0, 2 * d));
  rule.cutoff2 = std::max<uint64_t>(rule.cutoff2, 1);
  rule.widths.filter_frac = b;
  set_planar(rule);
  return rule;
}

// Halos as the machine builds them: records move along x, then y, then z, each time into the frame of the
// receiver.
std::array<std::vector<Int3>, emu::kSegments> halos(const Lattice& lattice,
                                                    const std::vector<std::vector<Int3>>& nodes, int p,
                                                    uint32_t node) {
  const auto along = [&](int axis, const auto& self,
                         uint32_t n) -> std::array<std::vector<Int3>, emu::kSegments> {
    std::array<std::vector<Int3>, emu::kSegments> segments;
    segments[0] = nodes[n];
    if (axis < 0) return segments;
    segments = self(axis - 1, self, n);
    for (int side = 0; side < 2; ++side) {
      const uint32_t other = lattice.neighbour(n, 2 * axis + side);
      if (other == kNoCell) continue;
      auto& halo = segments[static_cast<size_t>(1 + 2 * axis + side)];
      for (const auto& sent : self(axis - 1, self, other))
        for (Int3 x : sent) {
          x[static_cast<size_t>(axis)] += (side == 0 ? -1 : 1) * (int64_t{1} << p);
          halo.push_back(x);
        }
    }
    return segments;
  };
  return along(2, along, node);
}

void check(uint64_t seed, Stimuli& seen) {
  std::mt19937_64 random(seed);
  const auto draw = [&random](int low, int high) {
    return low + static_cast<int>(random() % static_cast<uint64_t>(high - low + 1));
  };
  const int p = seed % 5 == 0 ? 30 : draw(8, 30), d = draw(6, std::min(24, p)),
            b = draw(0, 2) == 0 ? 8 : draw(2, std::min(16, p));
  const FixedRule rule = rule_of(p, d, b, draw(0, 3) == 0 ? 1.0 : 0.01 * draw(1, 100));
  const bool ring = draw(0, 1) == 1;
  std::vector<Cell> cells;
  const int rows = draw(1, 3);
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < 3; ++x) cells.push_back({x, y, z});
  const Lattice lattice(cells, {ring ? 3 : 0, 0, ring ? 3 : 0});

  // Particles at random places, at the cell's faces, and at a plane's distance from another one.
  const int capacity = draw(1, 40), lanes = std::min(64, draw(1, 2 * capacity)),
            pipes = draw(1, std::min(lanes, 9));
  const int64_t cell = int64_t{1} << p;
  std::vector<std::vector<Int3>> nodes(lattice.size());
  for (auto& node : nodes)
    for (int n = draw(0, capacity); n > 0; --n) {
      Int3 x;
      for (int64_t& c : x)
        c = std::array{static_cast<int64_t>(random() % static_cast<uint64_t>(cell)), int64_t{0},
                       cell - 1}[static_cast<size_t>(std::max(0, draw(-4, 2)))];
      if (!node.empty() && draw(0, 1) == 1) {
        x = node.back();
        const size_t axes = static_cast<size_t>(draw(1, 3)), rest = (rule.planar[axes - 1] << (p - b));
        for (size_t a = 0; a < axes; ++a)
          x[a] =
              (x[a] + static_cast<int64_t>(rest / axes) + draw(-1, 1) * (int64_t{1} << (p - b))) & (cell - 1);
      }
      node.push_back(x);
    }

  std::array<std::vector<int32_t>, 3> x;
  std::vector<uint32_t> first;
  for (const auto& node : nodes) {
    first.push_back(static_cast<uint32_t>(x[0].size()));
    for (const Int3& c : node)
      for (size_t a = 0; a < 3; ++a) x[a].push_back(static_cast<int32_t>(c[a]));
  }
  first.resize(nodes.size() + 2, static_cast<uint32_t>(x[0].size()));
  for (auto& column : x) column.resize(column.size() + emu::Places::kBeyond, -1);
  std::vector<std::array<uint32_t, 6>> neighbour(nodes.size() + 1);
  neighbour.back().fill(lattice.size());
  for (uint32_t n = 0; n < lattice.size(); ++n)
    for (int f = 0; f < kFaces; ++f)
      neighbour[n][static_cast<size_t>(f)] = std::min(lattice.neighbour(n, f), lattice.size());
  const emu::Places places{{x[0].data(), x[1].data(), x[2].data()}, first.data(), neighbour.data()};
  const emu::Filter filter(rule, lanes, pipes);
  emu::HitScratch scratch(capacity, lanes);

  for (uint32_t n = 0; n < lattice.size(); ++n) {
    if (nodes[n].empty()) continue;
    const auto segments = halos(lattice, nodes, p, n);
    const int own = static_cast<int>(nodes[n].size()), passes = (own + lanes - 1) / lanes;
    std::array<uint32_t, emu::kSegments> items{};
    std::vector<uint32_t> entries;
    uint32_t item = 0;
    for (size_t s = 0; s < segments.size(); ++s)
      for (size_t k = 0; k < segments[s].size(); ++k)
        for (int pass = 0; pass < passes; ++pass, ++item, ++items[s]) {
          uint32_t hits = 0;
          for (int i = pass * lanes; i < std::min(own, (pass + 1) * lanes); ++i) {
            const Int3 &x_i = nodes[n][static_cast<size_t>(i)], &x_j = segments[s][k];
            int64_t sum = 0;
            for (size_t a = 0; a < 3; ++a) {
              const int64_t e = (x_j[a] >> (p - b)) - (x_i[a] >> (p - b));
              sum += e < 0 ? -e - 1 : e;
            }
            seen.on_plane += sum == rule.planar[2];
            seen.next_to_plane += sum == rule.planar[2] + 1;
            if (s == 0 && k == static_cast<size_t>(i)) continue;
            hits += may_interact(rule, x_i, x_j);
          }
          const auto f = static_cast<uint32_t>(pipes);
          if (hits > 0) entries.push_back(emu::ForceWork::entry(item, (hits + f - 1) / f));
        }
    const emu::ForceWork work = emu::filter_node(filter, places, n, scratch);
    ASSERT_EQ(work.items, items) << "seed " << seed << ", node " << n;
    ASSERT_TRUE(std::equal(entries.begin(), entries.end(), work.entries.begin(), work.entries.end()))
        << "seed " << seed << ", node " << n << ": P " << p << ", B " << b << ", " << lanes << " lanes, "
        << pipes << " pipes";
    seen.items += item;
    seen.entries += entries.size();
    seen.several_passes += passes > 1;
    seen.wide += p == 30;
  }
}

TEST(TimingHits, EveryVectorUnitEqualsTheRule) {
  int targets = 0;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    SCOPED_TRACE(hwy::TargetName(target));
    Stimuli seen;
    for (uint64_t seed = 1; seed <= 200; ++seed) {
      check(seed, seen);
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(seen.items, 500000u);
    EXPECT_GT(seen.entries, 10000u);
    EXPECT_LT(seen.entries, seen.items);
    EXPECT_GT(seen.on_plane, 100u);
    EXPECT_GT(seen.next_to_plane, 100u);
    EXPECT_GT(seen.several_passes, 100u);
    EXPECT_GT(seen.wide, 10u);
    ++targets;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  EXPECT_GT(targets, 0);
  RecordProperty("targets", targets);
}

}  // namespace
}  // namespace cuboct::test
