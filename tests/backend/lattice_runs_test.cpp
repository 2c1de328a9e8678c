// SPDX-License-Identifier: MIT
// Longer runs of the lattice engine against golden, each of which takes a path through the lists or through
// quiescence that short ones do not; counters prove that it was taken.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

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
    add_shot(scene, {7.5 + 0.4 * k, 0.4 + 0.9 * k, 0.6 + 0.8 * (k % 3)},
             {k % 2 == 0 ? 1.5 : -0.8, 0.3 - 0.2 * k, 0.5});
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

// Springs of the nearest neighbours alone, in coarse formats and strongly damped: a blow wakes all cells,
// then they come to rest one after another.
Case blow() {
  Scene scene =
      block_scene({.size = {3, 3, 3}, .cutoff = 1.3, .jitter = 0, .speed = 0, .damping = 0.6, .margin = 2});
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

// Particles of the last thread meet those of the first, who had no neighbours on other threads.
Case from_below() {
  Scene scene = block_scene(spheres({3, 3, 6}));
  for (int k = 0; k < 2; ++k)
    add_shot(scene, {1.1 + 1.3 * k, 1.4 + 0.8 * k, -1.2 - 0.3 * k}, {0.1, -0.2, 1.2});
  return cooked("from below", scene, 60);
}

// One particle flies far while all others rest: its list is mended all the way.
Case flyer() {
  Scene scene = block_scene(spheres({3, 3, 2}));
  scene.reach = {Vec3(0, 0, 0), Vec3(3, 3, 20)};
  add_shot(scene, {1.5, 1.4, 2 * kEdge + 0.6}, {0, 0.01, 1.3});
  return cooked("flyer", scene, 120);
}

// Shots at a block at rest, or between two that are squeezed together and fly apart, slow at first.
Case random_shots(uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  Features features = spheres({3, 3, 2});
  features.margin = 2;
  Scene scene = block_scene(features);
  const double top = 2 * kEdge;
  if (seed % 2 == 0) {
    for (int k = 0; k < 2; ++k)
      add_shot(scene, {3 * kEdge * uniform(), 3 * kEdge * uniform(), top + 0.6 + k + 0.3 * uniform()},
               {uniform() - 0.5, uniform() - 0.5, -0.2 - 1.3 * uniform()});
  } else {
    const double z = uniform(), y = uniform(), x = uniform();
    const Vec3 at(3 * kEdge * x, 3 * kEdge * y, top + 0.6 + z);
    add_shot(scene, at, Vec3::Zero());
    const double beside_y = uniform(), beside_x = uniform();
    add_shot(scene, at + Vec3(0.3 * beside_x, 0.3 * beside_y, 0.3), Vec3::Zero());
    scene.rule.dt = 0.05 + 0.2 * uniform();
  }
  return cooked("shots " + std::to_string(seed), scene, 60);
}

// A chain at rest is hit from below in x: its first group, all of whose cells lie ahead, must list the shot
// from two cells away, wherever the faces between them are. Or two pairs fly apart, and half of each against
// the other.
Case random_chain(uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  Features features = spheres({1, 1, 1});
  features.margin = 1.5;
  Scene scene = block_scene(features);
  scene.body = {};
  for (int k = 0; k < 24; ++k) add_shot(scene, {1.0 * k, 0, 0}, Vec3::Zero());
  if (seed % 4 != 0) {
    add_shot(scene, {-3 - uniform(), 0, 0}, Vec3::Zero());  // where the cells start
    add_shot(scene, {-0.99 - 0.1 * uniform(), 0.02 * uniform(), 0.02 * uniform()},
             {0.1 + 0.25 * uniform(), 0, 0});
  } else {
    const double gap = 1.6 + 0.4 * uniform(), squeeze = 0.35 + 0.3 * uniform();
    for (const double x : {0.0, squeeze, squeeze + gap, 2 * squeeze + gap})
      add_shot(scene, {2 + x, 2 + 0.02 * uniform(), 0.02 * uniform()}, Vec3::Zero());
  }
  return cooked("chain " + std::to_string(seed), scene, 25);
}

// A compressed crystal that fills its rings, in cells of a conventional one: each particle is pushed by
// twelve neighbours, whose kicks cancel to the last bit, until two of them are given a speed. Who is awake
// must feel those who sleep; and no sum of a sleeper may meet another particle in the ring of sums, which of
// three threads the second goes through twice: the two are four layers apart, one lap.
Case pressed() {
  constexpr double kPress = 0.9;
  Scene scene = block_scene({.size = {8, 8, 24}, .cutoff = 1.2, .jitter = 0, .speed = 0});
  for (Vec3& x : scene.body.x) x *= kPress;
  scene.periodic.origin = Vec3::Constant(-0.25 * kPress * kEdge);
  scene.periodic.extent = Vec3(8, 8, 24) * kPress * kEdge;
  const auto first_of = [](size_t x, size_t y, size_t z) { return 4 * (x + 8 * (y + 8 * z)); };
  scene.body.v[first_of(7, 5, 9)] = scene.body.v[first_of(3, 5, 13)] = {0.3, -0.2, 0.1};
  return cooked("pressed", scene, 6);
}

// The widest unit and plain integers, with and without threads.
void compare_some(const Case& c, bool quiescence, Count& count) {
  const auto all = variants(c.setup.plan);
  for (const std::string& simd : {all.front().simd, std::string("portable")})
    for (const int threads : {1, 3}) {
      compare(c, {threads, quiescence, simd}, count);
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

TEST(LatticeRuns, AHotGasIsSortedByCellAgainAndAgain) {
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

TEST(LatticeRuns, MendedListsJoinThreadsThatHadNoPairs) {
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(from_below(), quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_GT(count.lists.list_mends, 20u);
  }
}

TEST(LatticeRuns, AFlyerStaysAwakeThroughAllCells) {
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(flyer(), quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_EQ(count.faults, 0u);
    EXPECT_GT(count.lists.list_mends, 100u);
    EXPECT_GT(count.moves, 4 * 10u);
  }
}

// Golden names the lower id of the two; storage by cell puts it behind the other as often as not.
TEST(LatticeRuns, FaultsOfPairsNameTheLowerIdHoweverParticlesAreStored) {
  Count count;
  for (uint64_t seed = 1; seed <= 12; ++seed)
    for (const char* simd : {"", "portable"}) {
      compare(faulty_gas(seed), {1, true, simd}, count);
      if (HasFatalFailure()) return;
    }
  EXPECT_GT(count.faults, 12u);
  EXPECT_GT(count.lists.sorts, 12u);
}

TEST(LatticeRuns, RandomShotsTouchPartsOfTheLists) {
  Count count;
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const Case c = random_shots(seed);
    compare(c, {1 + static_cast<int>(seed % 2), true, seed % 4 == 0 ? "portable" : ""}, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.lists.near_parts, 500u);
  EXPECT_GT(count.lists.list_mends, 150u);
  EXPECT_GT(count.updates, 200000u);
}

TEST(LatticeRuns, RandomChainsAreHitAcrossFaces) {
  Count count;
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    compare(random_chain(seed), {1, true, ""}, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.lists.near_parts, 500u);
}

TEST(LatticeRuns, SleepersPushThoseAwake) {
  const Case c = pressed();
  ASSERT_EQ(c.setup.plan.lattice.period(), (Cell{8, 8, 24}));
  for (const bool quiescence : {false, true}) {
    Count count;
    compare_some(c, quiescence, count);
    if (HasFatalFailure()) return;
    EXPECT_EQ(count.lists.quiet_node_steps > 2 * 4 * 1000u, quiescence);
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
