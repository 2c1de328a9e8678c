// SPDX-License-Identifier: MIT
// The timing model against the native node stepped clock by clock: every phase span of every case.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "emu/lattice/engine.h"
#include "emu/systemc/node.h"
#include "emu/timing/timing.h"
#include "model/contract/golden.h"
#include "model/scene/scene.h"
#include "tests/backend/clocked_timing.h"
#include "tests/backend/engines.h"
#include "tests/support/block.h"
#include "tests/support/cases.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

class Timing : public testing::TestWithParam<std::string> {};

TEST_P(Timing, EqualsTheClockedNode) {
  Seen seen;
  const Case c = make_case(GetParam());
  EXPECT_EQ(difference(c, seen), "");
  EXPECT_EQ(seen.spans, c.steps * c.setup.plan.nodes() * kPhases);
}

INSTANTIATE_TEST_SUITE_P(Cases, Timing, testing::ValuesIn(case_names()),
                         [](const auto& p) { return p.param; });

void compare_random(uint64_t first, uint64_t last, Seen& seen) {
  for (uint64_t seed = first; seed <= last; ++seed) {
    const Case c = random_case(seed);
    ASSERT_EQ(difference(c, seen), "");
    ASSERT_EQ(difference(rebuilt(c, seed), seen), "");
  }
}

void compare_flat(uint64_t first, uint64_t last, Seen& seen) {
  for (uint64_t seed = first; seed <= last; ++seed) {
    const Case c = random_flat_case(seed);
    ASSERT_EQ(difference(c, seen), "");
    ASSERT_EQ(difference(rebuilt(c, seed), seen), "");
  }
}

void compare_rebuilt(uint64_t first, uint64_t last, Seen& seen) {
  for (const std::string& name : case_names())
    for (uint64_t seed = first; seed <= last; ++seed)
      ASSERT_EQ(difference(rebuilt(make_case(name), seed), seen), "");
}

constexpr uint64_t kSome = 24, kSomeFlat = 10;  // seeds of the default tier

// Of the full tier.
TEST(TimingRandomMore, EqualsTheClockedNode) {
  Seen seen;
  compare_random(kSome + 1, 300, seen);
  compare_flat(kSomeFlat + 1, 100, seen);
  compare_rebuilt(1, 4, seen);
  EXPECT_GT(seen.runs, 480u);
}

TEST(TimingRandom, EqualsTheClockedNode) {
  Seen seen;
  compare_random(1, kSome, seen);
  compare_flat(1, kSomeFlat, seen);
  // From which particles leave along several axes, and several leave one cell.
  for (const char* name : {"hot_gas", "lone_diagonal"}) {
    Case hot = make_case(name);
    hot.steps = std::min<uint64_t>(hot.steps, 20);
    ASSERT_EQ(difference(rebuilt(hot, 1), seen), "");
  }
  const std::vector<std::pair<const char*, uint64_t>> counts{{"spans", seen.spans},
                                                             {"runs", seen.runs},
                                                             {"faults", seen.faults},
                                                             {"stalls", seen.stalls},
                                                             {"multi_pass", seen.multi_pass},
                                                             {"multi_beat", seen.multi_beat},
                                                             {"empty_cells", seen.empty_cells},
                                                             {"full_cells", seen.full_cells},
                                                             {"leave", seen.leave},
                                                             {"leave_twice", seen.leave_twice},
                                                             {"leave_thrice", seen.leave_thrice},
                                                             {"crowds", seen.crowds},
                                                             {"emptied", seen.emptied},
                                                             {"checked", seen.checked},
                                                             {"no_overlap", seen.no_overlap},
                                                             {"queue_of_one", seen.queue_of_one},
                                                             {"pipes", seen.pipes},
                                                             {"shared", seen.shared},
                                                             {"narrow", seen.narrow},
                                                             {"serial", seen.serial},
                                                             {"coarse", seen.coarse},
                                                             {"bricks", seen.bricks},
                                                             {"arrival", seen.arrival},
                                                             {"streamers", seen.streamers},
                                                             {"pd", seen.pd},
                                                             {"weighted", seen.weighted},
                                                             {"damped", seen.damped},
                                                             {"rings_of_3", seen.rings_of_3},
                                                             {"lone_nodes", seen.lone_nodes},
                                                             {"flat", seen.flat},
                                                             {"not walked", seen.filtered - seen.walked}};
  seen.events["steps"] = seen.runs;
  for (const auto& [name, count] : event_names()) EXPECT_GT(seen.events[name], 0u) << name;
  for (const auto& [name, count] : counts) {
    RecordProperty(name, static_cast<int>(count));
    EXPECT_GT(count, 0u) << name;
  }
}

// Nodes that serve bricks: random plans, all features on lattices with holes, and a scene of many nodes.
TEST(TimingBricks, EqualTheClockedNode) {
  Seen seen;
  for (uint64_t seed = 1; seed <= 100; ++seed) ASSERT_EQ(difference(random_brick_case(seed), seen), "");
  EXPECT_EQ(seen.bricks, seen.runs);
  for (const std::string& name : case_names()) {
    const Case c = make_case(name);
    for (const Cell& brick : bricks_for(c.setup.plan.lattice))
      ASSERT_EQ(difference(with_brick(c, brick), seen), "");
  }
  for (const Case& c : {lumps({4.1, 4.3, -3.7}), lumps({-5.4, 3.6, 4.5}), make_case("hot_gas.detect"),
                        make_case("flat_gas.retry")}) {
    for (const Cell& brick : bricks_for(c.setup.plan.lattice))
      ASSERT_EQ(difference(with_brick(c, brick), seen), "");
  }
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/coupon.toml");
  ASSERT_EQ(difference(with_brick({"coupon", make_setup(scene, Arch{}), 4}, {4, 2, 3}), seen, 3), "");
  EXPECT_GT(seen.leave_twice, 20u);
  EXPECT_GT(seen.crowds, 20u);
  EXPECT_GT(seen.stalls, 100u);
  EXPECT_GT(seen.checked, 5u);
  EXPECT_GT(seen.multi_beat, 20u);
}

// Runs that a fault stops: the steps before it are as always.
TEST(TimingFaults, TheStepsBeforeAreEqual) {
  Seen seen;
  for (const Fault fault : all_faults()) EXPECT_EQ(difference(fault_case(fault), seen), "");
  for (const Fault fault : all_faults())
    EXPECT_EQ(difference(with_halos_on_arrival(fault_case(fault)), seen), "");
  EXPECT_EQ(seen.faults, 2 * all_faults().size());
  EXPECT_GT(seen.spans, 0u);
}

// Sparse lattices, resting parts, hundreds of nodes; several threads where there are enough for them.
TEST(TimingScenes, EqualTheClockedNode) {
  const std::vector<std::pair<std::string, uint64_t>> scenes{{"coupon", 12},    {"hot_cluster", 20},
                                                             {"lj_block", 12},  {"sheet", 8},
                                                             {"two_types", 20}, {"undamped_block", 20}};
  for (const auto& [name, steps] : scenes) {
    const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/" + name + ".toml");
    Case c{name, make_setup(scene, Arch{}), steps};
    Seen seen;
    EXPECT_EQ(difference(c, seen, 3), "");
    if (name == "coupon") {  // most of it has not been told yet that it is pulled
      EXPECT_GT(c.setup.plan.lattice.size(), 1000u);
      EXPECT_LT(seen.filtered, seen.busy);
      EXPECT_LT(seen.walked, seen.filtered);
    }
  }
}

// Particles at rest, and three that fly through them along the axes, forth and back: what is remembered of
// the resting nodes ends where one comes by or leaves.
TEST(TimingRest, EndsWhereSomethingMoves) {
  Seen seen;
  for (const double way : {1.0, -1.0}) {
    Scene scene = block_scene({.size = {4, 4, 4}, .jitter = 0, .speed = 0, .margin = 4});
    scene.rule.types[0].imposed = {true, true, true};
    scene.rule.types.push_back({.name = "flier"});
    for (int a = 0; a < 3; ++a) {
      const auto k = static_cast<size_t>(a);
      scene.body.type[k] = 1;
      scene.body.x[k] = Vec3::Constant(1.4 * a + 0.35);
      scene.body.x[k][a] = 2.5 - 4 * way;
      scene.body.v[k] = 4 * way * Vec3::Unit(a);
    }
    scene.steps = 14;
    EXPECT_EQ(difference({"fliers", make_setup(scene, Arch{}), scene.steps}, seen), "");
  }
  EXPECT_EQ(seen.runs, 2u);
  EXPECT_EQ(seen.faults, 0u);
  EXPECT_GT(seen.leave, 20u);
  EXPECT_GT(seen.filtered, 0u);
  EXPECT_LT(seen.filtered, seen.busy);
  EXPECT_LT(seen.walked, seen.busy);
}

TEST(TimingThreads, MoveParticlesAlike) {
  Case c{"hot", block({.size = {11, 11, 11}, .jitter = 0.1, .speed = 0.6}), 4};
  ASSERT_GT(c.setup.plan.lattice.size(), 1024u);
  Seen seen;
  EXPECT_EQ(difference(c, seen, 4), "");
  EXPECT_EQ(difference(c, seen, 1), "");
  EXPECT_GT(seen.leave_twice, 0u);
}

// Driven by the lattice engine, as it is meant to be.
TEST(TimingEngine, EqualsTheClockedNode) {
  uint64_t left = 0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const Case c = random_case(seed);
    const Plan& plan = c.setup.plan;
    emu::RunOptions options;
    options.steps = c.steps;
    const Trace trace =
        run_loop_bench(plan, c.setup.initial, options, emu::native_nodes(plan), "plain").trace;
    const auto& particles = c.setup.initial.particles;
    emu::LatticeEngine engine(plan, 0, static_cast<uint32_t>(particles.size()),
                              [&](uint32_t k) { return particles[k]; }, {});
    emu::TimingModel model(plan, 1);
    std::vector<PhaseSpan> spans(size_t{plan.lattice.size()} * kPhases);
    emu::CellSlots slots;
    for (uint64_t step = 0; step < trace.steps(); ++step) {
      engine.slots(slots);
      engine.step();
      model.step(slots, engine.leaving(), spans);
      left += engine.leaving().size();
      ASSERT_TRUE(std::equal(spans.begin(), spans.end(),
                             trace.cycles.begin() + static_cast<long>(step * spans.size())))
          << c.name << ", step " << step;
    }
  }
  EXPECT_GT(left, 100u);
}

TEST(TimingModel, RefusesWhatDoesNotFit) {
  const Case c = make_case("tight_capacity");
  const Plan& plan = c.setup.plan;
  const Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  const auto slots = slots_of(plan.rule, golden);
  std::vector<PhaseSpan> spans(size_t{plan.lattice.size()} * kPhases);
  const auto refusal = [&](const emu::CellSlots& given, const std::vector<emu::Leaving>& leaving,
                           std::span<PhaseSpan> into, int times = 1) -> std::string {
    emu::TimingModel model(plan, 1);
    return refused_with<std::invalid_argument>([&] {
      for (int k = 0; k < times; ++k) model.step(given, leaving, into);
    });
  };
  EXPECT_EQ(refusal(slots, {}, spans), "accepted");
  EXPECT_EQ(refusal(slots, {}, {}), "accepted");
  EXPECT_EQ(refusal(slots, {}, std::span(spans).subspan(1)), "spans of another lattice");
  auto wrong = slots;
  wrong.first.pop_back();
  EXPECT_EQ(refusal(wrong, {}, spans), "slots of another lattice");
  wrong = slots;
  wrong.x[1].pop_back();
  EXPECT_EQ(refusal(wrong, {}, spans), "slots without positions");
  wrong = slots;
  for (size_t n = 1; n < wrong.first.size(); ++n) wrong.first[n] = wrong.first.back();
  EXPECT_EQ(refusal(wrong, {}, spans), "a cell holds more than its capacity");
  EXPECT_EQ(refusal(slots, {{0, 200, {1, 0, 0}}}, spans), "no such particle leaves");
  EXPECT_EQ(refusal(slots, {{plan.lattice.size(), 0, {1, 0, 0}}}, spans), "no such particle leaves");
  uint32_t first = 0;  // node 0 is the lowest corner; the margin of this case is 0
  while (slots.first[first + 1] == 0) ++first;
  ASSERT_EQ(plan.lattice.neighbour(first, 0), kNoCell);
  EXPECT_EQ(refusal(slots, {{first, 0, {-1, 0, 0}}}, spans), "a particle leaves the lattice");
  EXPECT_EQ(refusal(slots, {{first, 0, {1, 0, 0}}}, spans, 2),
            "a cell does not hold what the step before left there");
  emu::TimingModel model(plan, 1);
  EXPECT_THROW(model.resume(std::vector<uint64_t>(plan.lattice.size() + 1)), std::invalid_argument);
}

// A run of no steps: DUMP alone.
TEST(TimingModel, CountsTheDump) {
  const Case c = make_case("single_node");
  const Plan& plan = c.setup.plan;
  const Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  emu::RunOptions options;
  const Trace trace = run_loop_bench(plan, c.setup.initial, options, emu::native_nodes(plan), "plain").trace;
  EXPECT_EQ(static_cast<double>(emu::TimingModel(plan, 1).cycles(slots_of(plan.rule, golden))),
            trace.counters.at(0).second);
}

// Hand-made: one node without neighbours and n particles, all of which see one another. EXCHANGE_X sends n
// records and an end beat and sees `sent` in the next cycle; y and z pass two and four empty segments as
// well. The streamer's n items begin to issue 6 cycles after the engine's first: F0 ... F3, queue, `current`.
TEST(TimingModel, OneNodeByHand) {
  Scene scene = block_scene({.size = {1, 1, 1}, .jitter = 0, .speed = 0, .margin = 0.1});
  Arch arch;
  arch.cell_edge = 12;
  Case c{"by hand", make_setup(scene, arch), 1};
  const Plan& plan = c.setup.plan;
  ASSERT_EQ(plan.lattice.size(), 1u);
  const Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  const uint64_t n = golden.cells()[0].size();
  ASSERT_EQ(n, 4u);
  std::vector<PhaseSpan> spans(kPhases);
  emu::TimingModel model(plan, 1);
  model.step(slots_of(plan.rule, golden), {}, spans);
  const uint64_t x = n + 1, y = x + 1 + n + 2 + 1, z = y + 1 + n + 4 + 1;
  EXPECT_EQ(spans[0], (PhaseSpan{0, x}));
  EXPECT_EQ(spans[1], (PhaseSpan{x + 1, y}));
  EXPECT_EQ(spans[2], (PhaseSpan{y + 1, z}));
  // 12 pairs, one per cycle from cycle 6 on, pass long before the last two segments are streamed after z.
  const uint64_t force = std::max(z + 1 + 2, 6 + n * (n - 1) - 1 + static_cast<uint64_t>(plan.latency.pipe));
  EXPECT_EQ(spans[3], (PhaseSpan{0, force}));
  const uint64_t update = force + n - 1 + static_cast<uint64_t>(plan.latency.update);
  EXPECT_EQ(spans[4], (PhaseSpan{force + 1, update}));
  // END, TAKE_LOW, TAKE_HIGH.
  for (uint64_t a = 0; a < 3; ++a)
    EXPECT_EQ(spans[5 + a], (PhaseSpan{update + 1 + 3 * a, update + 3 + 3 * a}));
}

}  // namespace
}  // namespace cuboct::test
