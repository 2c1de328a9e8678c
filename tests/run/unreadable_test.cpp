// SPDX-License-Identifier: MIT
// A density beyond the table of the embedding: of such a state no rounds can be run. The run ends, and keeps
// what it has.
#include <gtest/gtest.h>

#include "hw/engine/scene_engine.h"
#include "hw/plan/setup.h"
#include "model/base/steps.h"
#include "tests/run/kinds.h"

namespace cuboct::test {
namespace {

// Copper of this nearest distance, one half of which runs into the other.
Scene squeezed(const std::string& rule, const std::string& pitch = "1.85") {
  return parse_scene("mass = \"63.546 u\"\npacking = { pitch = \"" + pitch +
                         " angstrom\" }\ngeometry = { shape = \"box\", min = \"[0, 0, 0] angstrom\", max = "
                         "\"[6, 6, 6] angstrom\" }\n"
                         "velocity = [ { region = { shape = \"half_space\", point = \"[0, 3.1, 0] "
                         "angstrom\", normal = \"y\" }, uniform = \"[0, 20, 0] km/s\" } ]\n"
                         "run = { dt = \"0.2 fs\", steps = 200 }\n" +
                         rule,
                     CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
}

const std::string kForgets =
    "rule = { file = \"texts/eam.toml\", potential.file = \"texts/copper.eam.alloy\" }\n";
// Keeps the largest density that there was: looking at a state is not what a step does.
const std::string kRemembers =
    "[rule]\npotential.file = \"texts/copper.eam.alloy\"\nreach = \"cutoff\"\n"
    "particle.p = { unit = \"eV\" }\nparticle.most = { range = [0, 200] }\n"
    "[[rule.round]]\nsum.total = \"density(r)\"\nfinish.p = \"slope(embedding, total)\"\n"
    "finish.most = \"max(most, total)\"\n"
    "[[rule.round]]\nsum.force = \"slope(pair, r) / r * d + (p_i + p_j) * (slope(density, r) / r) * d\"\n"
    "[rule.energy]\npair = \"pair(r)\"\n";

RunRequest looking(uint64_t every) {
  RunRequest request;
  request.steps = 200;
  request.frames = {0};
  request.probes = every_so_often(every, 200);
  request.energies = true;
  return request;
}

void expect_told(const Trace& trace) {
  ASSERT_TRUE(trace.stop);
  EXPECT_EQ(trace.stop->fault, Fault::none);
  const std::string &text = trace.stop->text, step = "step " + std::to_string(trace.steps()) + ": particle ";
  EXPECT_EQ(text.find(step), 0u) << text;
  EXPECT_NE(text.find("the embedding of Cu is asked for at 100."), std::string::npos) << text;
  EXPECT_EQ(trace.stop->step, trace.steps());
  EXPECT_GT(trace.steps(), 5u);
  EXPECT_LT(trace.steps(), 200u);
}

TEST(Unreadable, NoStepOfARuleThatForgetsEndsThere) {
  const Scene scene = squeezed(kForgets);
  for (const Integrator integrator : {Integrator::semi_implicit_euler, Integrator::velocity_verlet})
    for (const uint64_t every : {1, 200}) {
      const Recorded run =
          record(scene, scene_reference_kind(scene, program_plan_of(scene, {}), {.integrator = integrator}),
                 looking(every));
      expect_told(run.trace);
      EXPECT_EQ(run.trace.curves.back().step.back(), run.trace.steps());
      EXPECT_EQ(run.trace.bodies.back().step, run.trace.steps());
    }
}

// Steps, curves and frames up to there are kept; its own energies and fields are not to be had.
TEST(Unreadable, ARuleThatRemembersKeepsTheTraceBefore) {
  const Scene scene = squeezed(kRemembers);
  const EngineKind kind = scene_reference_kind(scene, program_plan_of(scene, {}), {});
  for (const uint64_t every : {1, 200}) {
    const Recorded run = record(scene, kind, looking(every));
    expect_told(run.trace);
    EXPECT_EQ(run.trace.curves.back().step.back(), every == 1 ? run.trace.steps() - 1 : 0);
    ASSERT_EQ(run.trace.bodies.size(), 1u);
  }
}

TEST(Unreadable, IntegersKeepTheirHashes) {
  const Scene scene = squeezed(kForgets);
  const Plan plan = program_plan_of(scene, {});
  const Recorded looked = record(scene, golden_kind(scene, plan), looking(1));
  expect_told(looked.trace);
  EXPECT_EQ(looked.trace.curves.back().step.back() + 1, looked.trace.steps());
  // Where nobody looks, golden's own fault is told, and no other.
  const Recorded run = record(scene, golden_kind(scene, plan), looking(200));
  ASSERT_TRUE(run.trace.stop);
  EXPECT_EQ(run.trace.stop->fault, Fault::sum);
  EXPECT_EQ(run.trace.steps(), looked.trace.steps());
  EXPECT_EQ(run.trace.state_hash, looked.trace.state_hash);
  EXPECT_EQ(run.trace.curves.back().step, (std::vector<uint64_t>{0}));
}

TEST(Unreadable, ABodyAsPackedHasNoTrace) {
  const Scene scene = squeezed(kForgets, "1.5");
  const Plan plan = program_plan_of(scene, {});
  for (const EngineKind& kind : {scene_reference_kind(scene, plan, {}), golden_kind(scene, plan)}) {
    const Recorded run = record(scene, kind, looking(200));
    ASSERT_TRUE(run.trace.stop) << kind.name;
    const std::string& text = run.trace.stop->text;
    EXPECT_EQ(text.find("step 0: particle "), 0u) << text;
    EXPECT_NE(text.find("the embedding of Cu is asked for at"), std::string::npos) << text;
    EXPECT_EQ(run.trace.steps(), 0u);
  }
}

}  // namespace
}  // namespace cuboct::test
