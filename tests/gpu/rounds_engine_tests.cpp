// SPDX-License-Identifier: MIT
// Programs on the gpu engine, with loops for kernels: the pair law as a program beside golden, on every case.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "emu/gpu/rounds/rounds_engine.h"
#include "hw/engine/engine_kind.h"
#include "model/program/integer_program.h"
#include "tests/gpu/host_compiler.h"
#include "tests/gpu/rounds_beside_golden.h"
#include "tests/gpu/torn_glass.h"
#include "tests/support/cases.h"
#include "tests/support/counted_terms.h"

namespace cuboct::test {
namespace {

TEST(GpuRounds, EveryCaseHasGoldensBits) {
  Compared compared;
  for (const std::string& name : case_names()) compare_rounds(make_case(name), 1, compared);
  EXPECT_GT(compared.updates, 10000u);
}

TEST(GpuRounds, RandomCasesHaveGoldensBits) {
  Compared compared;
  for (uint64_t seed = 1; seed <= 80; ++seed) {
    compare_rounds(random_case(seed), seed, compared);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(compared.updates, 10000u);
  EXPECT_GT(compared.builds, 100u);
  // Golden decides what is doubtful, seldom more.
  EXPECT_LT(compared.golden_steps, compared.updates / 100);
}

TEST(GpuRounds, CellsThatAreNoCubesHaveGoldensBits) {
  Compared compared;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const Case c = uneven_case(seed);
    ASSERT_FALSE(c.setup.plan.rule.cubic());
    compare_rounds(c, seed, compared);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(compared.updates, 100000u);
  EXPECT_LT(compared.golden_steps, compared.updates / 100);
}

TEST(GpuRounds, FaultsAriseAsInGolden) {
  Compared compared;
  for (const Fault fault : all_faults()) compare_rounds(fault_case(fault), 3, compared);
  EXPECT_EQ(compared.faults, all_faults().size());
}

// A look at the next step counts particles in cells, too: the step that follows must not take them for its
// own.
TEST(GpuRounds, FaultsAriseAsInGoldenRightAfterALook) {
  for (const Fault fault : all_faults()) {
    Compared compared;
    compare_rounds(fault_case(fault), 3, compared, {}, 1);
    EXPECT_EQ(compared.faults, 1u) << to_string(fault);
  }
}

TEST(GpuRounds, RulesOfTextHaveGoldensBits) {
  const std::string rules = CUBOCT_SOURCE_DIR "/scenes/rules/";
  using Steps = std::pair<Scene, uint64_t>;
  for (auto [scene, steps] :
       {Steps(read_scene(rules + "heat.toml"), 90), Steps(torn_glass(rules), 90),
        Steps(read_scene(rules + "langevin.toml"), 20), Steps(read_scene(rules + "dpd.toml"), 30)}) {
    const Plan plan = program_plan_of(scene, Arch());
    const auto terms = count_terms(scene);
    const auto golden = integer_run(scene, plan, nullptr);
    std::vector<uint32_t> ids(scene.body.size());
    std::iota(ids.begin(), ids.end(), 0);
    const Asked asked{.ids = ids, .velocities = true};
    const Reading first = golden->read(asked);
    std::vector<uint64_t> expected{golden->hash()};
    golden->advance(steps, &expected);
    const Reading last = golden->read(asked);
    EXPECT_EQ(terms->made(), 0);
    for (const bool compiled : {false, true}) {
      const gpu::CompileRounds compile = compiled ? host_compiler("rule") : gpu::CompileRounds();
      const auto device = integer_run(scene, plan, nullptr, [&](const State& state) {
        return gpu::make_rounds_engine(plan, state, {}, compile);
      });
      const int made = terms->made();
      EXPECT_EQ(device->read(asked).v, first.v);
      std::vector<uint64_t> found{device->hash()};
      device->advance(steps, &found);
      EXPECT_EQ(found, expected);
      EXPECT_EQ(device->read(asked).v, last.v);
      EXPECT_EQ(terms->made(), made);
      EXPECT_EQ(note(device->notes(), "kernels"), compiled ? "compiled for host" : "interpreted");
      if (plan.program->rows == nullptr) continue;
      const std::vector<double> damage = device->damage();
      EXPECT_GT(std::ranges::count_if(damage, [](double d) { return d > 0.25; }), 20);
      EXPECT_EQ(damage, golden->damage());
      const Counters counters = device->counters();
      EXPECT_TRUE(std::ranges::count(counters, std::pair<std::string, double>("golden_steps", 0)));
    }
  }
}

// P of 30 bits: two cells apart are 2^31, and lists are made over coarser places.
TEST(GpuRounds, FinestPlacesHaveGoldensBits) {
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/rules/copper.toml");
  Arch arch;
  arch.widths.position_frac = 30;
  const Plan plan = program_plan_of(scene, arch);
  ASSERT_EQ(plan.program->program.position_frac, 30);
  const auto golden = integer_run(scene, plan, nullptr);
  const auto device = integer_run(
      scene, plan, nullptr, [&](const State& state) { return gpu::make_rounds_engine(plan, state, {}); });
  std::vector<uint64_t> expected, found;
  golden->advance(12, &expected), device->advance(12, &found);
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace cuboct::test
