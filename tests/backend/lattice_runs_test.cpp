// SPDX-License-Identifier: MIT
// Longer runs of the lattice engine against golden, each of which takes a path through the lists or through quiescence
// that short ones do not; counters prove that it was taken.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/backend/against_golden.h"
#include "tests/support/block.h"

namespace cuboct::test {
namespace {

const double kEdge = std::sqrt(2.0);  // of a conventional cell, pitches

// Spheres that repel below 0.95 pitches: a block at rest stays so to the last bit until something hits it.
Features spheres(const Cell& size) {
  return {.size = size, .cutoff = 0.95, .dt = 0.1, .jitter = 0, .speed = 0, .margin = 5};
}

void add_shot(Scene& scene, const Vec3& at, const Vec3& v) {
  scene.body.x.push_back(at);
  scene.body.v.push_back(v);
  scene.body.type.push_back(0);
}

Case cooked(const std::string& name, const Scene& scene, uint64_t steps, const Widths& widths = {}) {
  Arch arch;
  arch.capacity = 60;
  arch.widths = widths;
  return {name, make_setup(scene, arch), steps};
}

// Four particles fly into a block at rest.
Case impact() {
  Scene scene = block_scene(spheres({5, 5, 3}));
  for (int k = 0; k < 4; ++k)
    add_shot(scene, {2.6 + 0.9 * (k % 2), 2.9 + 1.1 * (k / 2), 3 * kEdge + 1.2}, {0.15, 0.1, -1.4});
  return cooked("impact", scene, 150);
}

// The same across the seam of a ring, while the lists are mended for others.
Case across_the_seam() {
  Scene scene = block_scene(spheres({4, 4, 4}));
  for (int a = 0; a < 3; ++a) {
    scene.periodic.origin[a] = -0.3;
    scene.periodic.extent[a] = (a == 0 ? 8 : 4) * kEdge;
  }
  for (int k = 0; k < 6; ++k)
    add_shot(scene, {7.5 + 0.4 * k, 0.4 + 0.9 * k, 0.6 + 0.8 * (k % 3)}, {k % 2 == 0 ? 1.5 : -0.8, 0.3 - 0.2 * k, 0.5});
  return cooked("across the seam", scene, 200);
}

// A hot gas in three rings: nobody keeps a neighbour.
Case hot_gas() {
  Scene scene = block_scene({.size = {4, 4, 4}, .cutoff = 1.4, .dt = 0.1, .jitter = 0.1, .speed = 0.7});
  for (int a = 0; a < 3; ++a) {
    scene.periodic.origin[a] = -0.3;
    scene.periodic.extent[a] = 4 * kEdge;
  }
  return cooked("hot gas", scene, 150);
}

// Two halves that part.
Case split() {
  Scene scene = block_scene({.size = {6, 3, 3}, .speed = 0.05, .margin = 4});
  for (size_t k = 0; k < scene.body.x.size(); ++k)
    scene.body.v[k].x() += scene.body.x[k].x() < 3 * kEdge ? -0.4 : 0.4;
  return cooked("split", scene, 80);
}

// Springs of the nearest neighbours alone, in coarse formats and strongly damped: a blow wakes all nodes, then they come
// to rest one after another.
Case blow() {
  Scene scene = block_scene({.size = {3, 3, 3}, .cutoff = 1.3, .jitter = 0, .speed = 0, .damping = 0.6, .margin = 2});
  scene.body.v[0] = {0.5, 0.4, 0.3};
  Widths widths;
  widths.position_frac = 12;
  widths.difference_frac = 12;
  widths.guard = 2;
  widths.velocity_bits = 15;
  widths.relative_velocity_frac = 14;
  widths.relative_velocity_bits = 15;
  return cooked("blow", scene, 400, widths);
}

// The widest unit and plain integers, with and without threads.
void compare_some(const Case& c, bool quiescence, Count& count) {
  const auto all = variants(c.setup.plan);
  for (const std::string& simd : {all.front().simd, std::string("portable")})
    for (const int threads : {1, 3}) {
      compare(c, {simd, threads, quiescence}, count);
      if (testing::Test::HasFatalFailure()) return;
    }
}

TEST(LatticeRuns, AnImpactMendsTheListsAndWakesWhatItMeets) {
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(impact(), quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_GT(count.lists.list_mends, 150u);
    EXPECT_GT(count.lists.list_builds, 40u);
    EXPECT_GT(count.moves, 500u);
    if (!quiescence) continue;
    EXPECT_GT(count.lists.near_parts, 200u);
    EXPECT_GT(count.lists.quiet_node_steps, count.lists.node_steps / 2);
    EXPECT_LT(count.lists.quiet_node_steps, count.lists.node_steps);
  }
}

TEST(LatticeRuns, ParticlesPassASeamWhileListsAreMended) {
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(across_the_seam(), quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_EQ(count.faults, 0u);
    EXPECT_GT(count.lists.list_mends, 100u);
    EXPECT_GT(count.lists.list_builds, 100u);
    EXPECT_GT(count.lists.sorts, 100u);
    if (!quiescence) continue;
    EXPECT_GT(count.lists.near_parts, 100u);
    EXPECT_GT(count.lists.quiet_node_steps, 10000u);
    // Four runs: more than the second step of each, so there were pauses.
    EXPECT_GT(count.resumed, 8u);
  }
}

TEST(LatticeRuns, AHotGasIsSortedByNodeAgainAndAgain) {
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(hot_gas(), quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_EQ(count.faults, 0u);
    EXPECT_GT(count.lists.sorts, 100u);
    EXPECT_GT(count.lists.list_builds, 200u);
    EXPECT_GT(count.moves, 5000u);
  }
}

TEST(LatticeRuns, ABodySplitsInTwo) {
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(split(), quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_GT(count.lists.list_builds, 40u);
    EXPECT_GT(count.lists.near_lists, count.lists.list_builds + 20);
    EXPECT_GT(count.moves, 2000u);
  }
}

TEST(LatticeRuns, ABlowInCoarseFormatsDiesAway) {
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(blow(), quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_GT(count.lists.list_mends, 40u);
    if (!quiescence) continue;
    EXPECT_GT(count.lists.near_parts, 150u);
    EXPECT_GT(count.lists.quiet_node_steps, 100000u);
  }
}

}  // namespace
}  // namespace cuboct::test
