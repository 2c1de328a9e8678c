// SPDX-License-Identifier: MIT
// Pairs that readings take, against all pairs one by one.
#include "model/analysis/near_pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/analysis/measure.h"

namespace cuboct {
namespace {

// A ring of 4 x 3 x 5 cells of 2 m with some 20 particles each within a cutoff of 1.9 m, of a law that is one
// number: kicks of -1/16 of the distance.
struct Ring {
  FixedRule fixed;
  Lattice lattice;
  State state;
  std::mt19937_64 dice{7};

  Ring() {
    std::vector<Cell> cells;
    for (int z = 0; z < 5; ++z)
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x) cells.push_back({x, y, z});
    lattice = Lattice(cells, {4, 3, 5});
    fixed.cell_edge = 2;
    fixed.dt = 0.5;
    fixed.mass = 3;
    const Widths& w = fixed.widths;
    fixed.cutoff2 = static_cast<uint64_t>(0.95 * 0.95 * std::ldexp(1.0, 2 * w.difference_frac));
    set_planar(fixed);
    fixed.force.value_frac = 16;
    fixed.force.c0.assign(512, -(1 << 12));
    fixed.force.c1.assign(512, 0);
    fixed.difference_shift = w.position_frac - w.difference_frac;
    fixed.kick_shift = fixed.force.value_frac + w.difference_frac - w.velocity_frac();
    fixed.types.resize(1);
    for (uint32_t id = 0; id < 400; ++id) {
      Particle p{id, 0, static_cast<uint32_t>(dice() % lattice.size()), {}, {}, {}};
      for (auto& x : p.x) x = static_cast<int64_t>(dice() % (uint64_t{1} << w.velocity_frac()));
      state.particles.push_back(p);
    }
  }
  int64_t place(uint32_t id, size_t axis) const {
    const Particle& p = state.particles[id];
    return (int64_t{lattice.cell(p.cell)[axis]} << fixed.widths.velocity_frac()) + p.x[axis];
  }
  // x_j - x_i of the nearest image, and the periods in it.
  Int3 difference(uint32_t i, uint32_t j, std::array<int8_t, 3>& image) const {
    Int3 d;
    for (size_t a = 0; a < 3; ++a) {
      const int64_t period = int64_t{lattice.period()[a]} << fixed.widths.velocity_frac();
      d[a] = place(j, a) - place(i, a);
      image[a] = static_cast<int8_t>(2 * d[a] > period ? -1 : 2 * d[a] < -period ? 1 : 0);
      d[a] += image[a] * period;
    }
    return d;
  }
  // All particles go by up to `far` cells along each axis.
  void move(double far) {
    const int frac = fixed.widths.velocity_frac();
    for (Particle& p : state.particles) {
      Cell cell = lattice.cell(p.cell);
      for (size_t a = 0; a < 3; ++a) {
        const double by = far * (2 * static_cast<double>(dice() % 1000) / 999 - 1);
        const int64_t whole = p.x[a] + static_cast<int64_t>(std::ldexp(by, frac));
        const int period = lattice.period()[a];
        cell[a] = (cell[a] + static_cast<int>(whole >> frac) + period) % period;
        p.x[a] = whole & ((int64_t{1} << frac) - 1);
      }
      p.cell = lattice.find(cell);
    }
    ++state.step;
  }
};

constexpr double kCutoff = 1.9;

// All blocks of all pairs; `across`: those inside the cutoff alone.
void take(const NearPairs& near, PairDistances& all, std::vector<PairAcross>& across) {
  for (size_t block = 0; block < near.blocks(); ++block) {
    PairDistances pairs;
    near.distances(block, kCutoff, pairs, across);
    for (size_t k = 0; k < pairs.count; ++k)
      all.i.push_back(pairs.i[k]), all.j.push_back(pairs.j[k]), all.r.push_back(pairs.r[k]);
  }
}

TEST(NearPairs, AreAllPairsInTheOrderOfIdsWhateverTheListsAge) {
  Ring ring;
  NearPairs near(ring.fixed, ring.lattice, 2);
  size_t seams = 0;
  for (int moves = 0; moves < 12; ++moves) {
    near.take(ring.state);
    PairDistances found;
    std::vector<PairAcross> across;
    take(near, found, across);
    size_t n = 0, m = 0;
    for (uint32_t i = 0; i < 400; ++i)
      for (uint32_t j = i + 1; j < 400; ++j) {
        std::array<int8_t, 3> image;
        const Int3 d = ring.difference(i, j, image);
        const double x = static_cast<double>(d[0]), y = static_cast<double>(d[1]),
                     z = static_cast<double>(d[2]);
        const double r =
            std::sqrt(x * x + (y * y + z * z)) * std::ldexp(2.0, -ring.fixed.widths.velocity_frac());
        if (r >= kCutoff) continue;
        ASSERT_LT(n, found.r.size());
        ASSERT_EQ(std::pair(found.i[n], found.j[n]), std::pair(i, j));
        ASSERT_EQ(found.r[n++], r);
        ASSERT_EQ(near.difference(i, j), d);
        if (image == std::array<int8_t, 3>{}) continue;
        while (m < across.size() && std::pair(across[m].i, across[m].j) != std::pair(i, j)) ++m;
        ASSERT_LT(m, across.size()) << i << " " << j;
        ASSERT_EQ(across[m].image, image);
        ++seams;
      }
    EXPECT_EQ(n, found.r.size());
    EXPECT_GT(n, 2000u);
    ring.move(0.01);
  }
  EXPECT_GT(seams, 1000u);
  // What readings cost: lists for a part of the states, and hardly more pairs than are inside.
  EXPECT_LE(near.lists_made(), 6u);
  EXPECT_GT(near.lists_made(), 1u);
}

// The sums by particles and images are the sum over pairs.
TEST(NearPairs, GiveTheVirialStressOfARing) {
  Ring ring;
  const Mat3 stress = virial_stress(ring.fixed, ring.lattice, ring.state, 1);
  Mat3 sum = Mat3::Zero();
  const double unit = std::ldexp(2.0, -ring.fixed.widths.velocity_frac());
  for (uint32_t i = 0; i < 400; ++i)
    for (uint32_t j = i + 1; j < 400; ++j) {
      std::array<int8_t, 3> image;
      const Int3 d = ring.difference(i, j, image);
      const Particle &a = ring.state.particles[i], &b = ring.state.particles[j];
      const Int3 x{a.x[0] + d[0], a.x[1] + d[1], a.x[2] + d[2]};
      const PairResult pair =
          pair_kick(ring.fixed, visible(ring.fixed, a.x), a.v, 0, visible(ring.fixed, x), b.v, 0);
      if (!pair.inside) continue;
      const Vec3 along(static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2]));
      sum += force_of(ring.fixed, pair.kick) * along.transpose() * unit;
    }
  EXPECT_GT(sum.norm(), 1);
  EXPECT_LT((stress - sum).norm(), 1e-12 * sum.norm());
}

}  // namespace
}  // namespace cuboct
