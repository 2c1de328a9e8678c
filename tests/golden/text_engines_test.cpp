// SPDX-License-Identifier: MIT
// Rules of text: the lattice engine has golden's bits, also where it goes on from golden's checkpoint.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "hw/plan/setup.h"
#include "model/run/checkpoint.h"
#include "model/scene/scene.h"

namespace cuboct {
namespace {

struct TextCase {
  std::string scene;
  uint64_t steps;
};

std::string stem_of(const TextCase& one) { return std::filesystem::path(one.scene).stem().string(); }

class TextEngines : public testing::TestWithParam<TextCase> {};

TEST_P(TextEngines, LatticeHasGoldensBitsAndGoesOnFromItsCheckpoint) {
  const std::string file = std::string(CUBOCT_SOURCE_DIR "/scenes/rules/") + GetParam().scene;
  const std::vector<StageName> stages = stages_of(file);
  const Scene scene = read_scene(file, {.stage = stages.empty() ? "" : stages.front().name});
  const Plan plan = program_plan_of(scene, Arch());
  const EngineKind golden_kind = cuboct::golden_kind(scene, plan);
  const auto golden = golden_kind.make(nullptr, false);
  std::vector<uint64_t> expected{golden->hash()};
  const uint64_t half = GetParam().steps / 2;
  golden->advance(half, &expected);
  const std::string path = testing::TempDir() + "text_engines_" + stem_of(GetParam()) + ".checkpoint";
  CheckpointHead head;
  head.plan_hash = plan.hash, head.step = half, head.particles = plan.particles;
  head.engine = golden->memory();
  write_checkpoint(path, head, *golden, plan.rule.pd);
  golden->advance(GetParam().steps - half, &expected);
  for (const emu::RuleCode code : {emu::RuleCode::interpreted, emu::RuleCode::compiled}) {
    const int threads = code == emu::RuleCode::compiled ? 3 : 1;
    const emu::LatticeChoice choice{
        .engine = {.threads = threads, .simd = {}, .rule_code = code, .code_directory = CUBOCT_RULE_CODE}};
    const EngineKind kind = emu::lattice_kind(scene, plan, choice);
    const auto lattice = kind.make(nullptr, false);
    std::vector<uint64_t> found{lattice->hash()};
    lattice->advance(GetParam().steps, &found);
    EXPECT_EQ(found, expected) << threads << " threads";
    CheckpointReader reader(path, plan.hash, plan.rule.pd);
    const auto resumed = kind.make(&reader, false);
    std::vector<uint64_t> rest;
    resumed->advance(GetParam().steps - half, &rest);
    EXPECT_EQ(rest,
              std::vector<uint64_t>(expected.begin() + static_cast<ptrdiff_t>(half) + 1, expected.end()));
  }
  std::remove(path.c_str());
}

INSTANTIATE_TEST_SUITE_P(Scenes, TextEngines,
                         testing::Values(TextCase{"heat.toml", 40}, TextCase{"../cracked_glass.toml", 60},
                                         TextCase{"plastic.toml", 60}, TextCase{"copper.toml", 20},
                                         TextCase{"langevin.toml", 20}, TextCase{"dpd.toml", 30}),
                         [](const auto& p) { return stem_of(p.param); });

}  // namespace
}  // namespace cuboct
