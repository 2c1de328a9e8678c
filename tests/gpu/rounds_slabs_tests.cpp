// SPDX-License-Identifier: MIT
// Rules of text on several devices that do their work in any order that events allow: golden's bits, however
// many slabs a scene has, and whatever crosses their borders.
#include <gtest/gtest.h>

#include <algorithm>

#include "emu/gpu/device/device.h"
#include "emu/gpu/rounds/rounds_halo.h"
#include "hw/engine/engine_kind.h"
#include "tests/gpu/beside_golden.h"
#include "tests/gpu/host_compiler.h"
#include "tests/gpu/rounds_beside_golden.h"
#include "tests/gpu/torn_glass.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

const std::string kSlabRules = CUBOCT_SOURCE_DIR "/scenes/rules/";

int planes_of(const Case& c) { return static_cast<int>(Owners(c.setup.plan, c.setup.initial, 1).planes()); }

// Particles rest but in the lowest slab: others learn of it alone that its particles have moved.
Case still_above(Case c, int slabs) {
  const Owners owners(c.setup.plan, c.setup.initial, slabs);
  for (Particle& p : c.setup.initial.particles)
    if (owners.of(p) > 0) p.v = {};
  return c;
}

class RoundsSlabs : public testing::Test {
 protected:
  RoundsSlabs() { gpu::Shuffle::all().on = true; }
  ~RoundsSlabs() override { gpu::Shuffle::all().on = false; }
};

TEST_F(RoundsSlabs, RandomCasesHaveGoldensBits) {
  Compared compared;
  auto& shuffle = gpu::Shuffle::all();
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Case c;
    try {
      c = seed % 3 == 0 ? random_case(seed) : random_bar(seed);
    } catch (const InputError&) {
      continue;
    }
    for (int slabs = 2; slabs <= std::min(planes_of(c), seed % 4 == 0 ? 5 : 3); ++slabs) {
      shuffle.random.seed(seed);
      compare_rounds(seed % 2 == 0 ? c : still_above(c, slabs), seed, compared, of_slabs(slabs),
                     seed % 5 == 0 ? 90 : 9);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(compared.runs, 60u);
  EXPECT_GT(compared.updates, 100000u);
  EXPECT_GT(compared.crossed, 50u);
  EXPECT_GT(compared.ghosts, 1000u);
  EXPECT_GT(compared.builds, 2 * compared.runs);
  EXPECT_GT(compared.faults, 5u);
  EXPECT_LT(compared.golden_steps, compared.updates / 100);
  EXPECT_GT(shuffle.overtaken, 1000u);
}

TEST_F(RoundsSlabs, FaultsAriseAsInGolden) {
  Compared compared;
  for (const Fault fault : all_faults()) {
    const Case c = fault_case(fault);
    compare_rounds(c, 3, compared, of_slabs(std::min(planes_of(c), 3)));
  }
  EXPECT_EQ(compared.faults, all_faults().size());
}

TEST_F(RoundsSlabs, CellsThatAreNoCubesHaveGoldensBits) {
  Compared compared;
  for (uint64_t seed = 1; seed <= 2; ++seed) compare_rounds(uneven_case(seed), seed, compared, of_slabs(2));
  EXPECT_GT(compared.updates, 10000u);
}

// Each slab's memory is of its own device.
TEST(RoundsMemory, IsOfTheDevicesThatAreNamed) {
  Case c = random_case(1);
  auto program = std::make_shared<IntegerProgram>();
  program->program = pair_program(c.setup.plan.rule, c.setup.plan.arch.capacity);
  c.setup.plan.program = program;
  auto& allocations = gpu::host_allocations;
  allocations.clear();
  gpu::Options options;
  options.devices = {1, 2};
  gpu::make_rounds_engine(c.setup.plan, c.setup.initial, options)->advance(2, nullptr);
  EXPECT_EQ(allocations.count(0), 0u);
  EXPECT_GT(allocations[1], 20u);
  EXPECT_GT(allocations[2], 20u);
}

// Of several stages the first.
Scene slab_scene(const std::string& name) {
  if (name == "torn") return torn_glass(kSlabRules);
  const std::string file = kSlabRules + name + ".toml";
  const std::vector<StageName> stages = stages_of(file);
  return read_scene(file, {.stage = stages.empty() ? "" : stages.front().name});
}

void compare_rule(const std::string& name, uint64_t steps, int slabs, const gpu::CompileRounds& compile) {
  SCOPED_TRACE(fmt::format("{}, {} slabs", name, slabs));
  const Scene scene = slab_scene(name);
  const Plan plan = program_plan_of(scene, Arch());
  const auto golden = integer_run(scene, plan, nullptr);
  const IntegerEngine* engine = nullptr;
  const auto engine_of = [&](int slabs) {
    return [&, slabs](const State& state) {
      auto made = gpu::make_rounds_engine(plan, state, of_slabs(slabs), compile);
      engine = made.get();
      return made;
    };
  };
  auto device = integer_run(scene, plan, nullptr, engine_of(slabs));
  std::vector<uint64_t> expected{golden->hash()}, found{device->hash()};
  golden->advance(steps, &expected), device->advance(steps, &found);
  // What so many devices leave others go on from, and what those leave.
  for (const int others : {1, slabs}) {
    device = integer_run(scene, plan, engine->state(), engine_of(others));
    golden->advance(3, &expected), device->advance(3, &found);
  }
  EXPECT_EQ(found, expected);
  EXPECT_EQ(device->damage(), golden->damage());
  const Counters counters = device->counters();
  EXPECT_TRUE(std::ranges::count(counters, std::pair<std::string, double>("golden_steps", 0)));
  EXPECT_FALSE(std::ranges::count(counters, std::pair<std::string, double>("halo_particles", 0)));
  EXPECT_EQ(note(device->notes(), "kernels"), compile ? "compiled for host" : "interpreted");
}

TEST_F(RoundsSlabs, RulesOfTextHaveGoldensBits) {
  compare_rule("heat", 60, 2, {});
  compare_rule("heat", 20, 3, host_compiler("slabs"));
  compare_rule("copper", 6, 2, {});
  compare_rule("torn", 40, 3, {});
  compare_rule("plastic", 20, 2, {});
  compare_rule("langevin", 12, 3, {});
  compare_rule("dpd", 20, 2, {});
}

// One of two blocks flies against the other, which rests.
Case flight(bool upper_flies) {
  Scene scene = block_scene({.size = {8, 2, 2}, .cutoff = 1.2, .jitter = 0, .speed = 0, .margin = 2.0});
  const double edge = make_setup(scene, Arch()).plan.rule.cell_edge;
  double low = INFINITY, high = -INFINITY;
  for (const Vec3& x : scene.body.x) low = std::min(low, x[0]), high = std::max(high, x[0]);
  const double up = upper_flies ? 1 : -1;
  for (size_t k = 0; k < scene.body.size(); ++k) {
    if (up * (scene.body.x[k][0] - 0.5 * (low + high)) < 0) continue;
    scene.body.x[k][0] += 1.5 * up * edge;
    scene.body.v[k][0] = -0.01 * up * edge / scene.rule.dt;
  }
  return {"flight", make_setup(scene, Arch()), 220, scene};
}

// Slabs end behind the lower block. Near lists of one at rest serve no longer when the other slab's particles
// have moved; ghosts come into the reach of its lists.
TEST_F(RoundsSlabs, ListsServeWhereOnlyOthersMove) {
  for (const bool upper_flies : {false, true}) {
    const Case c = flight(upper_flies);
    Compared compared;
    compare_rounds(c, 5, compared, of_slabs(2), 90);
    EXPECT_EQ(compared.updates, c.steps * c.setup.plan.particles);
    EXPECT_EQ(compared.golden_steps, 0u);
  }
}

}  // namespace
}  // namespace cuboct::test
