// SPDX-License-Identifier: MIT
// Bonded rules on native nodes beside golden, and their cycles beside the timing model's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "emu/timing/timing.h"
#include "model/program/integer_program.h"
#include "model/run/integer_run.h"
#include "tests/backend/clocked_timing.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

constexpr const char* kGlass = R"(density = "2440 kg/m^3"
[rule]
file = "texts/glass.toml"
parameters = { youngs_modulus = "72 GPa", poissons_ratio = 0.22, critical_stretch = 0.00091 }
start.whole = "not ((x_i.y - 1.2 mm) * (x_i.y + d0.y - 1.2 mm) < 0 and x_i.x + d0.x / 2 < 1 mm)"
[packing]
pitch = "1 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[3.5, 3, 2] mm"
[run]
dt = "0.04 us"
steps = 1
)";

constexpr const char* kPlastic = R"(density = "1.41 g/cm^3"
[rule]
file = "texts/plastic.toml"
[packing]
pitch = "1 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[3.5, 3, 2] mm"
[run]
dt = "0.2 us"
steps = 1
)";

// m/s: that of all, and at random up to this along each axis.
struct Motion {
  Vec3 together = Vec3::Zero();
  double apart = 0;
};

struct Body {
  Scene scene;
  Plan plan;
  State initial;

  Body(std::string text, const Motion& motion, const Arch& arch, uint64_t seed = 1) {
    scene = parse_scene(text, CUBOCT_SOURCE_DIR "/scenes/rules/small.toml");
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> any(-motion.apart, motion.apart);
    scene.body.v.resize(scene.body.size());
    for (Vec3& v : scene.body.v) v = motion.together + Vec3(any(random), any(random), any(random));
    scene.reach_margin = Vec3::Constant(4e-3);
    plan = program_plan_of(scene, arch, CellForm::cubes);
    initial = program_beginning(scene, {*plan.program, plan.rule, plan.lattice, plan.origin, plan.arch.capacity});
  }
  Golden golden() const {
    return {plan.program->program, plan.lattice, plan.arch.capacity, initial, plan.program->rows};
  }
  double cells_per_step(const Vec3& v) const { return v.cwiseAbs().maxCoeff() * plan.rule.dt / plan.rule.cell_edge; }
};

// What the stimuli contained.
struct Counts {
  uint64_t spans = 0, pairs = 0, broken = 0, changed = 0, filtered = 0, busy = 0;
  uint64_t moved = 0;       // particles that migrated; all have bonds
  uint64_t multi_pass = 0;  // cell-steps with more own particles than lanes
  std::vector<Fault> faults;
};

// Of the particles that golden's step takes to other cells; notes where they stood in `slots`.
std::vector<emu::Leaving> left(const Plan& plan, const Golden& before, const State& after) {
  std::vector<emu::Leaving> leaving;
  for (uint32_t n = 0; n < before.cells().size(); ++n)
    for (uint32_t slot = 0; slot < before.cells()[n].size(); ++slot) {
      const uint32_t to = after.particles[before.cells()[n][slot].id].cell;
      if (to == n) continue;
      emu::Leaving l{n, slot, {}};
      for (size_t a = 0; a < 3; ++a)
        l.away[a] = static_cast<int8_t>(plan.lattice.cell(to)[a] - plan.lattice.cell(n)[a]);
      leaving.push_back(l);
    }
  return leaving;
}

emu::CellSlots slots_with_ids(const Plan& plan, const Golden& golden) {
  emu::CellSlots slots = slots_of(plan.rule, golden);
  for (const auto& cell : golden.cells())
    for (const Particle& p : cell) slots.id.push_back(p.id);
  return slots;
}

std::vector<std::vector<uint32_t>> order_of(const Golden& golden) {
  std::vector<std::vector<uint32_t>> order;
  for (const auto& cell : golden.cells()) {
    auto& ids = order.emplace_back();
    for (const Particle& p : cell) ids.push_back(p.id);
  }
  return order;
}

// Runs the nodes and golden for `steps`, and compares hashes, states, orders and the fault that ends the run.
// Without stalls every span of a phase is the timing model's.
void compare(const Body& body, uint64_t steps, double stalls, Counts& counts) {
  const Plan& plan = body.plan;
  ASSERT_EQ(machine_refusal(plan), "");
  emu::RunOptions options;
  options.steps = steps;
  for (uint64_t step = 0; step <= steps; ++step) options.frames.push_back(step);
  options.keep_order = true;
  options.stall_rate = stalls;
  const emu::RunResult run = run_loop_bench(plan, body.initial, options, emu::native_nodes(plan), "plain");
  const Trace& trace = run.trace;

  Golden golden = body.golden();
  auto model = std::make_unique<emu::TimingModel>(plan, 1);
  std::vector<PhaseSpan> spans(spans_of_step(plan));
  const auto note = [&] {
    counts.busy += model->counters().busy, counts.filtered += model->counters().filtered;
    counts.pairs += sum(model->events()).pairs;
  };
  for (uint64_t step = 0;; ++step) {
    const State now = golden.state();
    ASSERT_EQ(trace.state_hash.at(step), hash_of(plan.lattice, now)) << step;
    ASSERT_EQ(trace.frames.at(step), now) << step;
    ASSERT_EQ(run.order.at(step), order_of(golden)) << step;
    if (step == steps) break;
    const Golden before = golden;
    try {
      golden.step();
    } catch (const RunError& e) {
      ASSERT_TRUE(trace.stop);
      EXPECT_EQ(trace.stop->text, e.what());
      EXPECT_EQ(trace.stop->step, step);
      ASSERT_EQ(trace.state_hash.size(), step + 1);
      counts.faults.push_back(e.fault);
      return;
    }
    const State after = golden.state();
    const std::vector<emu::Leaving> leaving = left(plan, before, after);
    counts.moved += leaving.size();
    for (size_t b = 0; b < now.bonds.size(); ++b) {
      counts.changed += now.bonds[b] != after.bonds[b];
      counts.broken += now.bonds[b] == 1 && after.bonds[b] == 0;
    }
    for (const auto& cell : before.cells())
      counts.multi_pass += static_cast<int>(cell.size()) > plan.arch.filter_lanes;
    if (stalls > 0) continue;
    if (step == steps / 2) {  // one that is told where another was goes on alike
      note();
      auto other = std::make_unique<emu::TimingModel>(plan, 1);
      other->resume(model->starts());
      model = std::move(other);
    }
    model->step(slots_with_ids(plan, before), leaving, spans);
    for (size_t k = 0; k < spans.size(); ++k, ++counts.spans)
      ASSERT_EQ(spans[k], trace.cycles.at(step * spans.size() + k)) << "step " << step << ", span " << k;
  }
  ASSERT_FALSE(trace.stop);
  if (stalls > 0) return;
  EXPECT_EQ(model->cycles(slots_with_ids(plan, golden)), static_cast<uint64_t>(trace.counters.at(0).second));
  note();
}

std::vector<Arch> machines() {
  std::vector<Arch> all(5);
  all[1].filter_lanes = 2, all[1].force_pipes = 2, all[1].queue_depth = 1;
  all[2].overlap = false, all[2].link_bits = 7;
  all[3].link_bits = 33, all[3].link_check = LinkCheck::retry, all[3].filter_lanes = 3;
  all[4].force_pipes = 4, all[4].queue_depth = 2, all[4].link_check = LinkCheck::detect;
  return all;
}

// 0.13 cells a step: all cross faces, and those near edges go on along a second axis.
const Vec3 kDrift(5000, -2500, 1700);

TEST(BondNodes, OfGlassThatBreaksHaveGoldensBitsAndTheModelsCycles) {
  Counts counts;
  for (const Arch& arch : machines()) {
    const Body body(kGlass, {kDrift, 8}, arch);
    EXPECT_GT(body.cells_per_step(kDrift), 0.05);
    compare(body, 12, 0, counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.moved, 100u);
  EXPECT_GT(counts.broken, 100u);
  EXPECT_GT(counts.multi_pass, 100u);
  EXPECT_GT(counts.pairs, 10000u);
  EXPECT_GT(counts.spans, 100000u);
  std::printf("moved %lu broken %lu multi %lu pairs %lu spans %lu filtered %lu busy %lu\n", counts.moved, counts.broken, counts.multi_pass, counts.pairs, counts.spans, counts.filtered, counts.busy);
}

TEST(BondNodes, OfASolidThatYieldsHaveGoldensBitsAndTheModelsCycles) {
  Counts counts;
  for (const Arch& arch : machines()) {
    compare(Body(kPlastic, {kDrift / 5, 20}, arch), 12, 0, counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.moved, 100u);
  EXPECT_GT(counts.changed, 1000u);
  std::printf("moved %lu changed %lu multi %lu pairs %lu spans %lu filtered %lu busy %lu\n", counts.moved, counts.changed, counts.multi_pass, counts.pairs, counts.spans, counts.filtered, counts.busy);
}

TEST(BondNodes, HaveGoldensBitsWhereLinksStall) {
  Counts counts;
  for (const Arch& arch : machines()) {
    compare(Body(kGlass, {kDrift, 8}, arch), 6, 0.3, counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.moved, 50u);
  EXPECT_GT(counts.broken, 30u);
}

// Who is where decides who is met, and not how far: while nobody migrates the filter need not look again.
TEST(BondNodes, AreNotFilteredAgainWhileNobodyMigrates) {
  Counts counts;
  compare(Body(kGlass, {Vec3::Zero(), 2}, Arch()), 10, 0, counts);
  EXPECT_EQ(counts.moved, 0u);
  // Each of two models looks once, in each of two rounds.
  EXPECT_EQ(counts.filtered * 10, counts.busy * 2);
  EXPECT_GT(counts.busy, 0u);
}

// Two particles, which fly apart.
std::string of_two(std::string text) {
  const std::string from = "[3.5, 3, 2] mm";
  return text.replace(text.find(from), from.size(), "[0.8, 0.8, 0.1] mm");
}

// Many lose bonds in one step, each several; of them the least is told.
TEST(BondNodes, ThatAreLostAreTheFaultOfGolden) {
  Counts counts;
  for (const Arch& arch : machines())
    for (const uint64_t seed : {1, 2, 3}) {
      const Body body(kGlass, {Vec3::Zero(), 30000}, arch, seed);
      compare(body, 4, seed == 3 ? 0.2 : 0, counts);
      if (HasFatalFailure()) return;
    }
  EXPECT_EQ(counts.faults, std::vector<Fault>(3 * machines().size(), Fault::bond_lost));
}

Body pair_apart(const char* text, double speed, const Arch& arch) {
  Body body(of_two(text), {Vec3::Zero(), speed}, arch);
  EXPECT_EQ(body.initial.particles.size(), 2u);
  return body;
}

TEST(BondNodes, ThatAreBrokenMayBeAnywhere) {
  Counts counts;
  for (const Arch& arch : machines()) {
    compare(pair_apart(kGlass, 4000, arch), 14, 0, counts);
    compare(pair_apart(kPlastic, 6000, arch), 4, 0, counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(counts.broken, 2 * machines().size());
  EXPECT_EQ(counts.faults, std::vector<Fault>(machines().size(), Fault::bond_lost));
}

TEST(BondNodes, WiderThanAWordAreRefused) {
  const Body body(kGlass, {}, Arch());
  EXPECT_EQ(refused_with<InputError>([&] { emu::check_words(body.plan, 400); }),
            "a record of " + std::to_string(body.plan.words.particle_bits) + " bits, " +
                std::to_string(body.plan.words.bonds) +
                " bonds among them: the cycle-accurate engines hold at most 400");
  Arch wide;
  wide.link_bits = 513;
  const Body beats(kPlastic, {}, wide);
  EXPECT_GT(beats.plan.words.particle_bits, 513);
  EXPECT_EQ(refused_with<InputError>([&] { emu::check_words(beats.plan); }),
            "a beat of 513 bits: the cycle-accurate engines hold at most 512\n  hint: use fewer link.bits");
}

}  // namespace
}  // namespace cuboct::test
