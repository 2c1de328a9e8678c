// SPDX-License-Identifier: MIT
// Nodes with bricks against golden, without the SystemC kernel: every feature, awkward lattices, random plans
// and bricks, stalls, checked links, faults.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "emu/systemc/node.h"
#include "model/scene/scene.h"
#include "tests/backend/engines.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

emu::RunResult run(const Case& c, double stall_rate = 0, uint64_t stall_seed = 1) {
  return run_loop_bench(c.setup.plan, c.setup.initial, keep_all(c.steps, stall_rate, stall_seed),
                        emu::native_nodes(c.setup.plan), "plain");
}

// What the stimuli contained.
struct Seen {
  uint64_t particles = 0, faults = 0;
  uint64_t nodes_of_one = 0;      // runs: the brick is the whole lattice
  uint64_t rings = 0;             // a node that is its own neighbour
  uint64_t pairs = 0;             // a node whose neighbours along an axis are one
  uint64_t ragged = 0;            // a node with fewer cells than its brick along an axis
  uint64_t absent = 0;            // a cell that the lattice has not
  uint64_t thin = 0, thick = 0;   // bricks of one, of more than three cells along an axis
  uint64_t inner = 0, outer = 0;  // particles that went to a cell of the same, of another node
  uint64_t crowded = 0;           // cells to which several particles went in a step
};

void note(Seen& seen, const Plan& plan, const GoldenRun& golden) {
  const Bricks& b = plan.bricks;
  seen.nodes_of_one += plan.nodes() == 1;
  for (uint32_t n = 0; n < plan.nodes(); ++n) {
    const Cell extent = b.extent(n);
    for (int a = 0; a < 3; ++a) {
      const uint32_t low = plan.neighbour(n, 2 * a);
      seen.rings += low == n;
      seen.pairs += low != n && low != kNoNode && low == plan.neighbour(n, 2 * a + 1);
      seen.ragged += extent[a] < b.shape()[a];
    }
    for (int32_t z = 0; z < extent[2]; ++z)
      for (int32_t y = 0; y < extent[1]; ++y)
        for (int32_t x = 0; x < extent[0]; ++x)
          seen.absent += b.cell(n, BrickGrid(b.shape()).local({x, y, z})) == kNoCell;
  }
  for (int a = 0; a < 3; ++a) seen.thin += b.shape()[a] == 1, seen.thick += b.shape()[a] > 3;
  for (size_t s = 1; s < golden.states.size(); ++s) {
    std::vector<int> came(plan.lattice.size());
    for (size_t k = 0; k < golden.states[s].particles.size(); ++k) {
      const uint32_t from = golden.states[s - 1].particles[k].cell, to = golden.states[s].particles[k].cell;
      if (from == to) continue;
      ++(b.node_of(from) == b.node_of(to) ? seen.inner : seen.outer);
      seen.crowded += ++came[to] == 2;
    }
  }
}

std::string difference(const Case& c, Seen& seen, double stall_rate = 0, uint64_t stall_seed = 1) {
  const GoldenRun golden = run_golden(c.setup, c.steps);
  const Compared compared = compare(c.setup.plan, golden, run(c, stall_rate, stall_seed));
  note(seen, c.setup.plan, golden);
  seen.particles += compared.particles;
  seen.faults += golden.fault.has_value();
  if (!compared.difference.empty() || compared.steps != golden.states.size())
    return fmt::format("{} with a brick of {}: {}", c.name, fmt::join(c.setup.plan.arch.brick, " x "),
                       compared.difference);
  return {};
}

TEST(Brick, EveryFeatureEqualsGolden) {
  Seen seen;
  for (const std::string& name : case_names()) {
    const Case c = make_case(name);
    uint64_t particles = seen.particles;
    for (const Cell& brick : bricks_for(c.setup.plan.lattice)) {
      ASSERT_EQ(difference(with_brick(c, brick), seen), "");
      EXPECT_EQ(seen.particles - particles, (c.steps + 1) * c.setup.initial.particles.size());
      particles = seen.particles;
    }
  }
  EXPECT_EQ(seen.faults, 0u);
  EXPECT_GT(seen.nodes_of_one, 10u);
  EXPECT_GT(seen.rings, 3u);
  EXPECT_GT(seen.pairs, 3u);
  EXPECT_GT(seen.ragged, 10u);
  EXPECT_GT(seen.thin, 10u);
  EXPECT_GT(seen.thick, 10u);
  EXPECT_GT(seen.inner, 200u);
  EXPECT_GT(seen.outer, 200u);
}

// Bricks with holes, links that not all cells of a face have: lumps of cells apart from one another.
TEST(Brick, SparseLatticesEqualGolden) {
  Seen seen;
  for (const Case& c : {lumps({4.1, 4.3, -3.7}), lumps({-5.4, 3.6, 4.5}), lumps({4, 0, 0})}) {
    EXPECT_LT(c.setup.plan.lattice.size(), bounding_cells(c.setup.plan.lattice));
    for (const Cell& brick : bricks_for(c.setup.plan.lattice))
      ASSERT_EQ(difference(with_brick(c, brick), seen), "");
  }
  EXPECT_EQ(seen.faults, 0u);
  EXPECT_GT(seen.absent, 500u);
  EXPECT_GT(seen.outer, 100u);
}

TEST(Brick, CouponEqualsGolden) {
  Seen seen;
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/coupon.toml");
  const Case c{"coupon", make_setup(scene, Arch{}), 2};
  ASSERT_EQ(difference(with_brick(c, {4, 4, 2}), seen), "");
  EXPECT_GT(seen.ragged, 0u);
}

TEST(Brick, RandomPlansEqualGolden) {
  Seen seen;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const Case c = random_brick_case(seed);
    ASSERT_EQ(difference(c, seen), "");
    ASSERT_EQ(difference(c, seen, 0.3, seed), "") << "stalled";
  }
  EXPECT_GT(seen.particles, 10000u);
  EXPECT_GT(seen.faults, 0u);
  EXPECT_GT(seen.crowded, 10u);
}

TEST(Brick, StallsChangeCyclesAndNoBits) {
  for (const char* name : {"hot_gas", "periodic_27", "flat_ring"}) {
    const Case c = with_brick(make_case(name), {2, 2, name[0] == 'f' ? 1 : 2});
    const emu::RunResult free = run(c), stalled = run(c, 0.3, 42);
    EXPECT_EQ(free.trace.state_hash, stalled.trace.state_hash);
    EXPECT_TRUE(free.order == stalled.order);
    EXPECT_FALSE(free.trace.cycles == stalled.trace.cycles);
    EXPECT_EQ(free.trace.cycles.size(), c.steps * c.setup.plan.nodes() * kPhases);
    EXPECT_EQ(free.trace.nodes, c.setup.plan.nodes());
  }
}

TEST(Brick, FaultsAreGoldens) {
  Seen seen;
  for (const Fault fault : all_faults()) {
    const Case c = fault_case(fault);
    for (const Cell& brick : bricks_for(c.setup.plan.lattice)) {
      ASSERT_EQ(difference(with_brick(c, brick), seen), "");
      ASSERT_EQ(difference(with_brick(c, brick), seen, 0.4), "");
    }
  }
  EXPECT_GE(seen.faults, 2 * all_faults().size());
}

}  // namespace
}  // namespace cuboct::test
