// SPDX-License-Identifier: MIT
// The timing model against the native node stepped clock by clock: every phase span of every case.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "emu/lattice/engine.h"
#include "emu/lattice/kicks.h"
#include "emu/lattice/timing.h"
#include "emu/systemc/node.h"
#include "model/contract/golden.h"
#include "model/scene/scene.h"
#include "tests/backend/engines.h"
#include "tests/support/block.h"
#include "tests/support/cases.h"

namespace cuboct::test {
namespace {

// What the stimuli contained.
struct Seen {
  uint64_t spans = 0, runs = 0, faults = 0;
  uint64_t stalls = 0;       // cycles in which a full queue held a streamer
  uint64_t multi_pass = 0;   // cell-steps with more own particles than lanes
  uint64_t multi_beat = 0;   // steps of plans whose records take several beats
  uint64_t empty_cells = 0;  // cell-steps
  uint64_t full_cells = 0;   // cell-steps that hold the capacity
  uint64_t leave = 0;        // particles that leave their cell in a step
  uint64_t leave_twice = 0;  // along two axes, so that an arrival leaves again
  uint64_t leave_thrice = 0;
  uint64_t crowds = 0;                          // cell-steps in which several particles leave one cell
  uint64_t emptied = 0;                         // cells that hold particles before a step and none after
  uint64_t busy = 0, filtered = 0, walked = 0;  // TimingCounters
  uint64_t checked = 0;
  uint64_t no_overlap = 0, queue_of_one = 0, pipes = 0, pd = 0, weighted = 0, damped = 0, rings_of_3 = 0,
           lone_nodes = 0, flat = 0, shared = 0, coarse = 0, narrow = 0, serial = 0, bricks = 0, arrival = 0,
           streamers = 0;
  std::map<std::string, uint64_t> events;
};

emu::CellSlots slots_of(const FixedRule& rule, const Golden& golden) {
  emu::CellSlots slots;
  for (const auto& cell : golden.cells()) {
    slots.first.push_back(static_cast<uint32_t>(slots.x[0].size()));
    for (const Particle& p : cell) {
      const Int3 x = visible(rule, p.x);
      for (size_t a = 0; a < 3; ++a) slots.x[a].push_back(static_cast<int32_t>(x[a]));
    }
  }
  slots.first.push_back(static_cast<uint32_t>(slots.x[0].size()));
  return slots;
}

// Where each particle is, by id: cell and slot.
std::map<uint32_t, std::pair<uint32_t, uint32_t>> places_of(const Golden& golden) {
  std::map<uint32_t, std::pair<uint32_t, uint32_t>> places;
  for (uint32_t n = 0; n < golden.cells().size(); ++n)
    for (uint32_t k = 0; k < golden.cells()[n].size(); ++k) places[golden.cells()[n][k].id] = {n, k};
  return places;
}

std::vector<emu::Leaving> leaving_between(const Lattice& lattice,
                                          const std::map<uint32_t, std::pair<uint32_t, uint32_t>>& before,
                                          const std::map<uint32_t, std::pair<uint32_t, uint32_t>>& after) {
  std::vector<emu::Leaving> leaving;
  for (const auto& [id, from] : before) {
    const uint32_t to = after.at(id).first;
    if (to == from.first) continue;
    emu::Leaving l{from.first, from.second, {}};
    for (size_t a = 0; a < 3; ++a) {
      int way = lattice.cell(to)[a] - lattice.cell(from.first)[a];
      if (lattice.period()[a] > 0 && std::abs(way) > 1) way = way > 0 ? -1 : 1;
      l.away[a] = static_cast<int8_t>(way);
    }
    leaving.push_back(l);
  }
  return leaving;  // by id: in no order that the model could rely on
}

void note(Seen& seen, const Plan& plan, const Golden& golden, const std::vector<emu::Leaving>& leaving) {
  const auto& arch = plan.arch;
  for (const auto& cell : golden.cells()) {
    seen.multi_pass += static_cast<int>(cell.size()) > arch.filter_lanes;
    seen.empty_cells += cell.empty();
    seen.full_cells += static_cast<int>(cell.size()) == arch.capacity;
  }
  std::map<uint32_t, uint32_t> from;
  for (const auto& l : leaving) {
    const int axes = (l.away[0] != 0) + (l.away[1] != 0) + (l.away[2] != 0);
    ++seen.leave;
    seen.leave_twice += axes == 2;
    seen.leave_thrice += axes == 3;
    seen.crowds += ++from[l.cell] == 2;
  }
  for (const auto& [cell, count] : from) seen.emptied += count == golden.cells()[cell].size();
  seen.multi_beat += plan.words.halo_beats > 1 || plan.words.migrate_beats > 1;
}

// The first event that the model counts otherwise than the clocked nodes of a run without a stop.
std::string other_events(const MachineEvents& events, const Trace& trace, Seen& seen) {
  for (const auto& [name, count] : event_names()) {
    if (std::string(name) == "steps") continue;
    const auto found = std::ranges::find(trace.counters, name, &std::pair<std::string, double>::first);
    if (found == trace.counters.end()) return fmt::format("no counter of {}", name);
    if (static_cast<double>(events.*count) != found->second)
      return fmt::format("{} {}, expected {}", events.*count, name, found->second);
    seen.events[name] += events.*count;
  }
  std::array<uint64_t, kPhases> cycles{};
  for (size_t k = 0; k < trace.cycles.size(); ++k)
    cycles[k % kPhases] += trace.cycles[k].end + 1 - trace.cycles[k].start;
  if (cycles != events.phase_cycles) return "other cycles of phases";
  if (events.steps != trace.steps() * trace.nodes) return "other steps of nodes";
  return {};
}

void count_work(Seen& seen, const emu::TimingModel& model) {
  seen.busy += model.counters().busy;
  seen.filtered += model.counters().filtered;
  seen.walked += model.counters().walked;
}

// Runs both and compares; the text of the first difference.
std::string difference(const Case& c, Seen& seen, int threads = 1) {
  const Plan& plan = c.setup.plan;
  emu::RunOptions options;
  options.steps = c.steps;
  const Trace trace = run_plain(plan, c.setup.initial, options, emu::native_nodes(plan), "plain").trace;
  const uint32_t nodes = plan.nodes();

  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, c.setup.initial);
  auto model = std::make_unique<emu::TimingModel>(plan, threads);
  std::vector<PhaseSpan> spans(size_t{nodes} * kPhases);
  MachineEvents events;
  emu::KickCounter kicks(plan, threads);
  std::vector<MachineEvents> kicked(nodes);
  for (uint64_t step = 0; step < trace.steps(); ++step) {
    const auto slots = slots_of(plan.rule, golden);
    const auto before = places_of(golden);
    const Golden old = golden;
    kicks.add(golden.state().particles, kicked);
    golden.step();
    const auto leaving = leaving_between(plan.lattice, before, places_of(golden));
    note(seen, plan, old, leaving);
    // A model that is made anew and told where it was goes on alike.
    if (step == trace.steps() / 2) {
      count_work(seen, *model);
      events += sum(model->events());
      auto other = std::make_unique<emu::TimingModel>(plan, threads);
      other->resume(model->starts());
      model = std::move(other);
    }
    model->step(slots, leaving, spans);
    for (size_t k = 0; k < spans.size(); ++k, ++seen.spans) {
      const PhaseSpan expected = trace.cycles[step * spans.size() + k];
      if (spans[k] == expected) continue;
      return fmt::format("{}, step {}, node {}, {}: cycles {} to {}, expected {} to {}", c.name, step,
                         k / kPhases, to_string(static_cast<Phase>(k % kPhases)), spans[k].start,
                         spans[k].end, expected.start, expected.end);
    }
  }
  if (!trace.stop) {
    const auto counted = static_cast<uint64_t>(trace.counters.at(0).second);
    const uint64_t cycles = model->cycles(slots_of(plan.rule, golden));
    if (cycles != counted) return fmt::format("{}: {} cycles, expected {}", c.name, cycles, counted);
    events += sum(model->events());
    events += sum(kicked);
    const std::string other = other_events(events, trace, seen);
    if (!other.empty()) return fmt::format("{}: {}", c.name, other);
  }
  count_work(seen, *model);
  ++seen.runs;
  seen.faults += trace.stop.has_value();
  for (const auto& [name, value] : trace.counters)
    if (name == "queue_stalls") seen.stalls += static_cast<uint64_t>(value);
  seen.no_overlap += !plan.arch.overlap;
  seen.checked += plan.link.checked();
  seen.queue_of_one += plan.arch.queue_depth == 1;
  seen.pipes += plan.arch.force_pipes > 1;
  seen.shared += plan.arch.multipliers == Multipliers::shared;
  seen.serial += plan.arch.multipliers == Multipliers::serial;
  seen.narrow += plan.arch.narrow_memories;
  seen.bricks += plan.bricks.cells() > 1;
  seen.arrival += plan.arch.halos == Halos::arrival;
  seen.streamers += plan.arch.streamers > 1;
  seen.coarse += plan.rule.widths.filter_frac != Widths{}.filter_frac;
  seen.pd += plan.rule.pd;
  seen.weighted += plan.rule.weighted && !plan.rule.pd;
  seen.damped += plan.rule.damped;
  const Cell& period = plan.lattice.period();
  seen.rings_of_3 += period[0] == 3 || period[1] == 3 || period[2] == 3;
  seen.lone_nodes += nodes == 1;
  seen.flat += plan.rule.axes == 2;
  return {};
}

// The most particles that a cell holds in the case's steps.
int crowd_of(const Case& c) {
  size_t most = 1;
  for (const auto& step : run_golden(c.setup, c.steps).order)
    for (const auto& cell : step) most = std::max(most, cell.size());
  return static_cast<int>(most);
}

// The same scene and rule on another machine: everything of the arch that only changes cycles is drawn anew.
// The capacity is sometimes what the fullest cell holds.
Case rebuilt(Case c, uint64_t seed) {
  std::mt19937_64 random(seed * 7919);
  const auto draw = [&random](int low, int high) {
    return low + static_cast<int>(random() % static_cast<uint64_t>(high - low + 1));
  };
  Plan& plan = c.setup.plan;
  Arch arch = plan.arch;
  arch.filter_lanes = std::array{draw(1, 4), draw(5, 20), draw(21, 64)}[static_cast<size_t>(draw(0, 2))];
  arch.force_pipes = draw(1, std::min(arch.filter_lanes, draw(1, 8)));
  arch.queue_depth = std::array{1, draw(2, 4), draw(5, 30), 1024}[static_cast<size_t>(draw(0, 3))];
  arch.multipliers = static_cast<Multipliers>(draw(0, 2));
  arch.overlap = draw(0, 3) > 0;
  arch.narrow_memories = draw(0, 3) == 0;
  arch.halos = Halos::phases;
  arch.streamers = 1;
  if (arch.narrow_memories)
    arch.filter_lanes = arch.force_pipes = 1, arch.overlap = false, arch.brick = {1, 1, 1};
  arch.link_bits = std::array{0, draw(1, 8), draw(9, 200), 1024}[static_cast<size_t>(draw(0, 3))];
  if (draw(0, 2) == 0) arch.capacity = crowd_of(c);
  if (draw(0, 2) == 0 && !arch.narrow_memories) {
    const std::vector<Cell> bricks = bricks_for(plan.lattice);
    if (!bricks.empty())
      arch.brick = bricks[static_cast<size_t>(draw(0, static_cast<int>(bricks.size()) - 1))];
  }
  // The clocked node holds checked beats of 512 bits.
  arch.link_check = arch.link_bits <= 200 ? static_cast<LinkCheck>(draw(0, 2)) : LinkCheck::none;
  if (!arch.narrow_memories && cells_of(arch.brick) == 1 && draw(0, 2) == 0) {
    arch.halos = Halos::arrival;
    arch.overlap = true;
    arch.streamers = arch.filter_lanes > 1 ? draw(1, 2) : 1;
    arch.force_pipes = arch.streamers * draw(1, std::min(arch.filter_lanes / arch.streamers, 3));
  }
  plan = make_plan(plan.rule, arch, plan.lattice, plan.origin, plan.particles);
  c.name += " rebuilt";
  return c;
}

class Timing : public testing::TestWithParam<std::string> {};

TEST_P(Timing, EqualsTheClockedNode) {
  Seen seen;
  const Case c = make_case(GetParam());
  EXPECT_EQ(difference(c, seen), "");
  EXPECT_EQ(seen.spans, c.steps * c.setup.plan.nodes() * kPhases);
}

INSTANTIATE_TEST_SUITE_P(Cases, Timing, testing::ValuesIn(case_names()),
                         [](const auto& p) { return p.param; });

TEST(TimingRandom, EqualsTheClockedNode) {
  Seen seen;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const Case c = random_case(seed);
    ASSERT_EQ(difference(c, seen), "");
    ASSERT_EQ(difference(rebuilt(c, seed), seen), "");
  }
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    const Case c = random_flat_case(seed);
    ASSERT_EQ(difference(c, seen), "");
    ASSERT_EQ(difference(rebuilt(c, seed), seen), "");
  }
  for (const std::string& name : case_names())
    for (uint64_t seed = 1; seed <= 4; ++seed)
      ASSERT_EQ(difference(rebuilt(make_case(name), seed), seen), "");
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
    const Trace trace = run_plain(plan, c.setup.initial, options, emu::native_nodes(plan), "plain").trace;
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
    try {
      for (int k = 0; k < times; ++k) model.step(given, leaving, into);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(slots, {}, spans), "");
  EXPECT_EQ(refusal(slots, {}, {}), "");
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
  const Trace trace = run_plain(plan, c.setup.initial, options, emu::native_nodes(plan), "plain").trace;
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
