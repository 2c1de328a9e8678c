// SPDX-License-Identifier: MIT
// Bonded rules on native nodes beside golden, and their cycles beside the timing model's.
#include <gtest/gtest.h>

#include "emu/machine/loop_bench.h"
#include "emu/systemc/node.h"
#include "model/program/integer_program.h"
#include "model/run/integer_run.h"
#include "tests/backend/bond_cases.h"
#include "tests/backend/clocked_timing.h"
#include "tests/backend/engines.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

// What the stimuli contained. All particles have bonds, so those that migrate take them along.
struct Counts {
  uint64_t moved = 0, broken = 0, changed = 0;
  std::vector<Fault> faults;
};

std::vector<std::vector<uint32_t>> order_of(const Golden& golden) {
  std::vector<std::vector<uint32_t>> order;
  for (const auto& cell : golden.cells()) {
    auto& ids = order.emplace_back();
    for (const Particle& p : cell) ids.push_back(p.id);
  }
  return order;
}

// Runs the nodes and golden for `steps`, and compares hashes, states, orders and the fault that ends the run.
void compare(const BondedCase& body, uint64_t steps, double stalls, Counts& counts) {
  const Plan& plan = body.c.setup.plan;
  const State& initial = body.c.setup.initial;
  ASSERT_EQ(machine_refusal(plan), "");
  emu::RunOptions options;
  options.steps = steps;
  for (uint64_t step = 0; step <= steps; ++step) options.frames.push_back(step);
  options.keep_order = true;
  options.stall_rate = stalls;
  const emu::RunResult run = run_loop_bench(plan, initial, options, emu::native_nodes(plan), "plain");
  const Trace& trace = run.trace;
  Golden golden = golden_of(body.c.setup);
  for (uint64_t step = 0;; ++step) {
    const State now = golden.state();
    ASSERT_GT(trace.state_hash.size(), step) << (trace.stop ? trace.stop->text : "");
    ASSERT_EQ(trace.state_hash[step], hash_of(plan.lattice, now)) << step;
    ASSERT_EQ(trace.frames.at(step), now) << step;
    ASSERT_EQ(run.order.at(step), order_of(golden)) << step;
    if (step == steps) break;
    try {
      golden.step();
    } catch (const RunError& e) {
      ASSERT_TRUE(trace.stop);
      EXPECT_EQ(trace.stop->text, e.what());
      ASSERT_EQ(trace.state_hash.size(), step + 1);
      counts.faults.push_back(e.fault);
      return;
    }
    const State after = golden.state();
    for (size_t k = 0; k < now.particles.size(); ++k)
      counts.moved += now.particles[k].cell != after.particles[k].cell;
    for (size_t b = 0; b < now.bonds.size(); ++b) {
      counts.changed += now.bonds[b] != after.bonds[b];
      counts.broken += now.bonds[b] == 1 && after.bonds[b] == 0;
    }
  }
  ASSERT_FALSE(trace.stop);
}

std::vector<Arch> machines() {
  std::vector<Arch> all(5);
  all[1].filter_lanes = 2, all[1].force_pipes = 2, all[1].queue_depth = 1;
  all[2].overlap = false, all[2].link_bits = 7;
  all[3].link_bits = 33, all[3].link_check = LinkCheck::retry, all[3].filter_lanes = 3;
  all[4].force_pipes = 4, all[4].queue_depth = 2, all[4].link_check = LinkCheck::detect;
  return all;
}

// Some 0.1 cells of glass a step: all cross faces, and those near edges go on along a second axis.
const Vec3 kDrift(5000, -2500, 1700);

TEST(BondNodes, OfGlassThatBreaksHaveGoldensBitsAndTheModelsCycles) {
  Counts counts;
  Seen seen;
  for (const Arch& arch : machines()) {
    const BondedCase body(kGlass, {kDrift, 8}, arch);
    compare(body, body.c.steps, 0, counts);
    if (HasFatalFailure()) return;
    EXPECT_EQ(difference(body.c, seen), "");
  }
  EXPECT_GT(counts.moved, 100u);
  EXPECT_GT(counts.broken, 100u);
  EXPECT_GT(seen.leave_twice, 0u);
  EXPECT_GT(seen.multi_pass, 50u);
  EXPECT_GT(seen.stalls, 10u);
  EXPECT_GT(seen.events["pairs_issued"], 10000u);
  EXPECT_GT(seen.spans, 50000u);
}

TEST(BondNodes, OfASolidThatYieldsHaveGoldensBitsAndTheModelsCycles) {
  Counts counts;
  Seen seen;
  for (const Arch& arch : machines()) {
    const BondedCase body(kPlastic, {kDrift / 5, 20}, arch);
    compare(body, body.c.steps, 0, counts);
    if (HasFatalFailure()) return;
    EXPECT_EQ(difference(body.c, seen), "");
  }
  EXPECT_GT(counts.moved, 100u);
  EXPECT_GT(counts.changed, 1000u);
  EXPECT_GT(seen.spans, 50000u);
}

const std::string kSize = "[geometry]\nshape = \"box\"\nmin = \"[0, 0, 0] mm\"\nmax = \"[3.5, 3, 2] mm\"\n";

// Bonds across the seams of a ring of three cells, and of a layer without a third axis.
TEST(BondNodes, OfBoxesAndOfLayersHaveGoldensBitsAndTheModelsCycles) {
  Counts ring, layer;
  Seen seen;
  for (const Arch& arch : machines()) {
    const BondedCase box(replaced(kPlastic, kSize, "[box]\nperiodic = \"xyz\"\ncells = [4, 3, 3]\n"),
                         {kDrift / 5, 20}, arch, 4);
    const BondedCase sheet(
        replaced(replaced(kGlass, kSize,
                          "[geometry]\nshape = \"box\"\nmin = \"[0, 0, -0.5] mm\"\n"
                          "max = \"[5, 4, 0.5] mm\"\n"),
                 "pitch = \"1 mm\"\n", "pitch = \"1 mm\"\naxes = [[1, -1, 0], [1, 1, -2]]\n"),
        {kDrift, 20, 0, true}, arch);
    ASSERT_EQ(box.c.setup.plan.lattice.period(), (Cell{4, 3, 3}));
    ASSERT_EQ(sheet.c.setup.plan.rule.axes, 2);
    compare(box, box.c.steps, 0, ring);
    compare(sheet, sheet.c.steps, 0, layer);
    if (HasFatalFailure()) return;
    EXPECT_EQ(difference(box.c, seen), "");
    EXPECT_EQ(difference(sheet.c, seen), "");
  }
  EXPECT_GT(ring.moved, 50u);
  EXPECT_GT(layer.moved, 50u);
  EXPECT_GT(layer.broken, 20u);
}

TEST(BondNodes, HaveGoldensBitsWhereLinksStall) {
  Counts counts;
  for (const Arch& arch : machines()) {
    compare(BondedCase(kGlass, {kDrift, 8}, arch), 6, 0.3, counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(counts.moved, 50u);
  EXPECT_GT(counts.broken, 30u);
}

// Who is where decides who is met, and not how far: while nobody migrates the filter need not look again.
TEST(BondNodes, AreNotFilteredAgainWhileNobodyMigrates) {
  Seen seen;
  EXPECT_EQ(difference(BondedCase(kGlass, {Vec3::Zero(), 2}, Arch(), 10).c, seen), "");
  EXPECT_EQ(seen.leave, 0u);
  EXPECT_GT(seen.busy, 0u);
  EXPECT_EQ(seen.filtered * 10, seen.busy * 2);  // once by each of two models
}

// Many lose bonds in one step, each several; of them the least is told.
TEST(BondNodes, ThatAreLostAreTheFaultOfGolden) {
  Counts counts;
  for (const Arch& arch : machines())
    for (const double stalls : {0.0, 0.2}) {
      compare(BondedCase(kGlass, {Vec3::Zero(), 10, 0.9}, arch), 4, stalls, counts);
      if (HasFatalFailure()) return;
    }
  EXPECT_EQ(counts.faults, std::vector<Fault>(2 * machines().size(), Fault::bond_lost));
}

TEST(BondNodes, ThatAreBrokenMayBeAnywhereAndOthersMayNot) {
  Counts counts;
  for (const Arch& arch : machines()) {
    const BondedCase glass(of_four(kGlass), {Vec3::Zero(), 0, 0.3}, arch),
        plastic(of_four(kPlastic), {Vec3::Zero(), 0, 3.6}, arch);
    ASSERT_EQ(glass.c.setup.initial.particles.size(), 4u);
    compare(glass, 14, 0, counts);
    compare(plastic, 4, 0, counts);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(counts.broken, 12 * machines().size());
  EXPECT_EQ(counts.faults, std::vector<Fault>(machines().size(), Fault::bond_lost));
}

TEST(BondNodes, WiderThanAWordAreRefused) {
  const BondedCase body(kGlass, {}, Arch());
  EXPECT_EQ(refused_with<InputError>([&] { emu::check_words(body.c.setup.plan, 400); }),
            "a record of " + std::to_string(body.c.setup.plan.words.particle_bits) + " bits, " +
                std::to_string(body.c.setup.plan.words.bonds) +
                " bonds among them: the cycle-accurate engines hold at most 400");
  Arch wide;
  wide.link_bits = 513;
  const BondedCase beats(kPlastic, {}, wide);
  EXPECT_GT(beats.c.setup.plan.words.particle_bits, 513);
  EXPECT_EQ(refused_with<InputError>([&] { emu::check_words(beats.c.setup.plan); }),
            "a beat of 513 bits: the cycle-accurate engines hold at most 512\n  hint: use fewer link.bits");
}

}  // namespace
}  // namespace cuboct::test
