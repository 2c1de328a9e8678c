// SPDX-License-Identifier: MIT
// The lattice engine shared by MPI ranks against golden: run under mpirun, with any number of ranks.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "emu/lattice/engine.h"
#include "emu/lattice/mpi_ranks.h"
#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "hw/plan/setup.h"
#include "model/scene/scene.h"
#include "tests/backend/against_golden.h"
#include "tests/support/block.h"
#include "tests/support/cases.h"
#include "tests/support/counted_terms.h"

namespace cuboct::test {
namespace {

emu::MpiRanks* world = nullptr;

const std::vector<std::string> kCuts{"bricks", "x", "y", "z"};

// Each case is cut in each way between two and between four ranks. Between others it takes one cut in turn:
// one rank cuts nothing, and more ranks than cores wait for each other most of the time.
bool thorough() { return world->size() == 2 || world->size() == 4; }

std::vector<std::string> cuts_of(size_t index) {
  if (thorough()) return kCuts;
  return {kCuts[index % kCuts.size()]};
}

TEST(Ranks, HoldGoldensBitsInEachCase) {
  Count count;
  const std::vector<std::string> names = case_names();
  for (size_t i = 0; i < names.size(); ++i)
    for (const std::string& cut : cuts_of(i)) {
      compare(make_case(names[i]), {1, cut != "x", "", world, cut}, count);
      if (HasFatalFailure()) return;
    }
  EXPECT_GT(count.updates, 0u);
}

TEST(Ranks, HoldGoldensBitsInRandomCases) {
  Count count;
  const uint64_t seeds = thorough() ? 60 : 24;
  for (uint64_t seed = 1; seed <= seeds; ++seed) {
    compare(random_case(seed), {1 + static_cast<int>(seed % 2), seed % 3 != 0, "", world, kCuts[seed % 4]},
            count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.updates, 160 * seeds);
  EXPECT_GT(count.moves, seeds);
  EXPECT_GT(count.faults, 0u);
}

TEST(Ranks, MeetEachFaultAlike) {
  Count count;
  for (const Fault fault : all_faults()) {
    compare(fault_case(fault), {1, true, "", world, "bricks"}, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(count.faults, all_faults().size());
}

TEST(Ranks, HoldGoldensBitsOfPrograms) {
  Count count;
  const std::vector<std::string> names = case_names();
  for (size_t i = 0; i < names.size(); i += 3) {
    compare(as_program(make_case(names[i])), {1, i % 2 == 0, "", world, kCuts[i % 4]}, count);
    if (HasFatalFailure()) return;
  }
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    compare(as_program(random_case(seed)), {2, seed % 3 != 0, "", world, kCuts[seed % 4]}, count);
    if (HasFatalFailure()) return;
  }
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    compare(uneven_case(seed), {1, seed % 2 == 0, "", world, kCuts[seed % 4]}, count);
    if (HasFatalFailure()) return;
  }
  for (const Fault fault : {Fault::sum, Fault::velocity}) {
    compare(as_program(fault_case(fault)), {1, true, "", world, "bricks"}, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.updates, 1000u);
  EXPECT_GT(count.faults, 1u);
}

// Fields, bonds and several rounds across ranks.
TEST(Ranks, HoldGoldensBitsOfRulesOfText) {
  for (const std::string name : {"heat", "../cracked_glass", "plastic", "copper", "dpd"}) {
    SCOPED_TRACE(name);
    const std::string file = CUBOCT_SOURCE_DIR "/scenes/rules/" + name + ".toml";
    const std::vector<StageName> stages = stages_of(file);
    Scene scene = read_scene(file, {.stage = stages.empty() ? "" : stages.front().name});
    const Plan plan = program_plan_of(scene, Arch());
    const auto terms = count_terms(scene);
    const auto golden = golden_kind(scene, plan).make(nullptr, false);
    const emu::LatticeChoice choice{.engine = {.threads = 1,
                                               .simd = {},
                                               .ranks = world,
                                               .cut = name == "../cracked_glass" ? "y" : "bricks",
                                               .rule_code = name == "heat" || name == "plastic"
                                                                ? emu::RuleCode::interpreted
                                                                : emu::RuleCode::compiled,
                                               .code_directory = CUBOCT_RULE_CODE}};
    const auto lattice = emu::lattice_kind(scene, plan, choice).make(nullptr, false);
    std::vector<uint64_t> expected{golden->hash()}, found{lattice->hash()};
    std::vector<uint32_t> ids(scene.body.size());
    std::iota(ids.begin(), ids.end(), 0);
    // A reading begins the step that comes next.
    const Asked asked{.ids = ids, .velocities = true, .fields = name == "heat"};
    for (const uint64_t steps : {3u, 5u}) {
      const Reading there = golden->read(asked), here = lattice->read(asked);
      if (lattice->leads()) {
        ASSERT_EQ(here.v, there.v);
        ASSERT_EQ(here.x, there.x);
        ASSERT_EQ(here.fields, there.fields);
        ASSERT_EQ(here.v.size(), ids.size());
      }
      ASSERT_EQ(lattice->hash(), golden->hash());
      golden->advance(steps, &expected);
      lattice->advance(steps, &found);
      ASSERT_EQ(found, expected);
    }
    EXPECT_EQ(terms->made(), 0);
  }
}

// Lists are made anew many times, and particles change ranks.
TEST(Ranks, HoldGoldensBitsWhileParticlesChangeRanks) {
  Count count;
  Features features;
  features.size = {5, 5, 5};
  features.speed = 0.5;
  Case c{"warm block", block(features), 60};
  compare(c, {1, true, "", world, "bricks"}, count);
  EXPECT_GT(count.lists.list_builds, 3u);
  EXPECT_GT(count.moves, 200u);
}

// Golden names the least fault, whichever rank meets it and however often particles changed ranks before.
TEST(Ranks, HoldGoldensBitsInAHotGasUpToItsFault) {
  Count count;
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    compare(faulty_gas(seed), {1, seed % 2 == 0, "", world, kCuts[seed - 1]}, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(count.faults, 1u);
  EXPECT_GT(count.lists.list_builds, 20u);
  EXPECT_GT(count.moves, 400u);
}

// Where a rank stores nobody is not far from where it stored somebody before: the lists last as long as on
// one rank.
TEST(Ranks, KeepTheirListsAsLongAsOneRankDoes) {
  Features features;
  features.size = {6, 3, 3};
  features.speed = 0.3;
  const Case c{"warm bar", block(features), 40};
  Count count;
  compare(c, {1, false, "", world, "x"}, count);
  if (HasFatalFailure()) return;
  const auto& start = c.setup.initial.particles;
  emu::LatticeEngine alone(c.setup.plan, 0, static_cast<uint32_t>(start.size()),
                           [&](uint32_t k) { return start[k]; }, {1, false, "", world, "bricks"});
  for (uint64_t s = 0; s < c.steps; ++s) alone.step();
  // One engine mends a list where ranks make it anew.
  EXPECT_LE(count.lists.list_builds, alone.counters().list_builds + alone.counters().list_mends + 1);
  EXPECT_GT(count.lists.list_builds, 3u);
}

TEST(Ranks, RefuseAnUnknownCut) {
  if (world->size() == 1) GTEST_SKIP() << "nothing to cut";
  const Case c = make_case("single_node");
  const auto& start = c.setup.initial.particles;
  try {
    emu::LatticeEngine(c.setup.plan, 0, static_cast<uint32_t>(start.size()),
                       [&](uint32_t k) { return start[k]; }, {1, true, "", world, "diagonal"});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("unknown cut 'diagonal'"), std::string::npos);
  }
}

}  // namespace
}  // namespace cuboct::test

int main(int argc, char** argv) {
  cuboct::emu::MpiRanks ranks(&argc, &argv);
  cuboct::test::world = &ranks;
  testing::InitGoogleTest(&argc, argv);
  if (ranks.rank() != 0)
    delete testing::UnitTest::GetInstance()->listeners().Release(
        testing::UnitTest::GetInstance()->listeners().default_result_printer());
  uint64_t failed = RUN_ALL_TESTS() != 0;
  ranks.sum({&failed, 1});
  return failed != 0;
}
