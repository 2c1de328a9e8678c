// SPDX-License-Identifier: MIT
// [[stage]], [start] and `until` of a scene, as the reader takes them.
#include <gtest/gtest.h>

#include <string>

#include "model/base/error.h"
#include "model/config/config.h"
#include "model/scene/scene.h"

namespace cuboct {
namespace {

const std::string kGrips = CUBOCT_SOURCE_DIR "/scenes/boards/grips.toml";

Scene parsed(const std::string& more, const std::string& stage) {
  return parse_scene(read_config_text(kGrips) + "\n" + more, "s.toml", {.begins = true, .stage = stage});
}

const std::string kStages = R"(
[[stage]]
name = "relax"
steps = 7
damping = { ratio = 0.5 }
constraint = [{ name = "right", velocity = [0, 0, 0] }]

[[stage]]
name = "load"
duration = 1.4
dt = 0.07
gravity = [0, 0, -0.01]
until = { probe = "grip.force_x", beyond = 0.2, after = 0.35 }
probe_every = 2
constraint = [{ name = "left", free = true }]
)";

TEST(Stage, ReplacesKeysOfTheScene) {
  const Scene base = parsed("", ""), relax = parsed(kStages, "relax"), load = parsed(kStages, "load");
  EXPECT_EQ(relax.stage, "relax");
  EXPECT_EQ(relax.steps, 7u);
  EXPECT_EQ(relax.rule.dt, 0.14);
  EXPECT_DOUBLE_EQ(relax.rule.damping.coefficient, 5 * base.rule.damping.coefficient);
  EXPECT_FALSE(relax.until);
  EXPECT_EQ(load.steps, 20u);
  EXPECT_EQ(load.rule.dt, 0.07);
  EXPECT_EQ(load.rule.damping.coefficient, base.rule.damping.coefficient);
  EXPECT_EQ(load.probe_every, 2u);
  EXPECT_EQ(load.rule.types[0].gravity, Vec3(0, 0, -0.01));
  ASSERT_TRUE(load.until);
  EXPECT_EQ(load.until->curve, "grip.force_x");
  EXPECT_EQ(load.until->after, 5u);
  EXPECT_TRUE(load.until->holds(-0.2));
  EXPECT_FALSE(load.until->holds(0.19));
  const auto type = [](const Scene& scene, const std::string& name) -> const ParticleType* {
    for (const ParticleType& one : scene.rule.types)
      if (one.name == name) return &one;
    return nullptr;
  };
  ASSERT_TRUE(type(relax, "matter/right"));
  EXPECT_EQ(type(relax, "matter/right")->velocity, Vec3::Zero());
  EXPECT_EQ(type(load, "matter/right")->velocity, Vec3(0.03, -0.01, 0));
  EXPECT_TRUE(type(relax, "matter/left"));
  EXPECT_FALSE(type(load, "matter/left"));
  EXPECT_EQ(relax.body.x, base.body.x);
}

const std::string kRamps = R"(
[[stage]]
name = "start"
steps = 10
parts = 4
gravity = { from = [0, 0, 0], to = [0, 0, -0.8] }
until = { probe = "grip.force_x", beyond = 0.2, after = 0.56 }
constraint = [{ name = "right", velocity = { from = [0.08, 0, 0], to = [0, 0, -0.08] } }]

[[stage]]
name = "hold"
)";

// Parts of 3 steps, the values those of the middles: 1, 3, 5 and 7 eighths of the way.
TEST(Stage, ARampRunsInPartsOfItsMiddles) {
  double way = 0;
  for (int part = 0; part < 4; ++part) {
    const Scene scene = parsed(kRamps, "start-" + std::to_string(part + 1));
    const double along = (2 * part + 1) / 8.0;
    EXPECT_EQ(scene.steps, 3u);
    EXPECT_LT((scene.rule.types[0].gravity - Vec3(0, 0, -0.8 * along)).norm(), 1e-15);
    const ParticleType& right = scene.rule.types.back();
    ASSERT_EQ(right.name, "matter/right");
    EXPECT_LT((right.velocity - Vec3(0.08 - 0.08 * along, 0, -0.08 * along)).norm(), 1e-15);
    way += right.velocity.x() * static_cast<double>(scene.steps) * scene.rule.dt;
    // 0.56 are 4 steps of 0.14: one step of the second part.
    EXPECT_EQ(scene.until->after, part == 0 ? 4u : part == 1 ? 1u : 0u);
  }
  EXPECT_NEAR(way, 0.08 / 2 * 12 * 0.14, 1e-15);  // that of the straight line
  const std::string no_gravity =
      kRamps.substr(0, kRamps.find("gravity")) + kRamps.substr(kRamps.find("until"));
  EXPECT_EQ(parsed(no_gravity, "hold").steps, 24u);
  EXPECT_EQ(parsed(kRamps, "hold").rule.types.back().velocity, Vec3(0.03, -0.01, 0));
}

const std::string kHand = R"(
[[stage]]
name = "pull"
steps = 5
planned_steps = 40
constraint = [
  { name = "left", free = true },
  { name = "hand", kind = "moved", velocity = [0, 0, 0.02], region = { shape = "sphere", radius = 1.2 } },
]

[[stage]]
name = "rest"
)";

// Of the packing, and of that stage alone. Later constraints take particles from earlier ones.
TEST(Stage, MayHaveConstraintsOfItsOwn) {
  const Scene pull = parsed(kHand, "pull"), rest = parsed(kHand, "rest"), base = parsed("", "");
  const auto of = [](const Scene& scene, const std::string& name) {
    std::vector<uint32_t> ids;
    for (uint32_t id = 0; id < scene.body.size(); ++id)
      if (scene.rule.types[scene.body.type[id]].name == name) ids.push_back(id);
    return ids;
  };
  std::vector<uint32_t> near;
  for (uint32_t id = 0; id < base.body.size(); ++id)
    if (base.body.x[id].norm() <= 1.2) near.push_back(id);
  ASSERT_FALSE(near.empty());
  EXPECT_EQ(of(pull, "matter/hand"), near);
  EXPECT_EQ(pull.rule.types[pull.body.type[near[0]]].velocity, Vec3(0, 0, 0.02));
  EXPECT_EQ(rest.body.type, base.body.type);
  EXPECT_EQ(rest.rule.types.size(), base.rule.types.size());
}

TEST(Stage, IsPlannedForMoreStepsThanItHas) {
  const Scene pull = parsed(kHand, "pull"), rest = parsed(kHand, "rest");
  EXPECT_EQ(pull.steps, 5u);
  EXPECT_DOUBLE_EQ(pull.planned_duration(), 40 * pull.rule.dt);
  EXPECT_DOUBLE_EQ(rest.planned_duration(), static_cast<double>(rest.steps) * rest.rule.dt);
  // That of [run] is of stages without a length of their own.
  const auto of_run = [](const std::string& stage) {
    std::string text = read_config_text(kGrips) + "\n" + kHand;
    const size_t run = text.find("[run]\n") + 6;
    text.insert(run, "planned_steps = 90\n");
    return parse_scene(text, "s.toml", {.begins = true, .stage = stage});
  };
  EXPECT_EQ(of_run("pull").planned_steps, 40u);
  EXPECT_EQ(of_run("rest").planned_steps, 90u);
}

std::string refusal(const std::string& more, const std::string& stage) {
  try {
    parsed(more, stage);
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(0, what.find('\n'));
  }
  return "";
}

TEST(Stage, IsRefusedWithItsPlace) {
  EXPECT_EQ(refusal(kStages, ""), "s.toml:49:1: the scene has 2 stages: --stage takes one");
  EXPECT_EQ(refusal(kStages, "pull"), "s.toml has no stage 'pull'");
  EXPECT_EQ(refusal("", "pull"), "s.toml has no stages, and no stage 'pull'");
  EXPECT_EQ(refusal("[[stage]]\nname = \"a\"\nstpes = 3\n", "a"), "s.toml:50:1: unknown key 'stpes'");
  EXPECT_EQ(refusal("[[stage]]\nname = \"a\"\n[[stage]]\nname = \"a\"\n", "a"),
            "s.toml:51:8: stage 'a' is there twice");
  const std::string a = "[[stage]]\nname = \"a\"\n";
  EXPECT_EQ(refusal(a + "steps = 9\nplanned_steps = 8\n", "a"),
            "s.toml:51:17: 'planned_steps' is less than the run's 9 steps");
  EXPECT_EQ(refusal(a + "constraint = [{ name = \"left\", kind = \"held\", region = { shape = \"sphere\", "
                        "radius = 1 } }]\n",
                    "a"),
            "s.toml:50:24: constraint 'left' is there twice");
  EXPECT_EQ(refusal(a + "constraint = [{ name = \"lift\", free = true }]\n", "a"),
            "s.toml:50:24: unknown constraint 'lift'");
  EXPECT_EQ(refusal(a + "constraint = [{ name = \"left\", velocity = [1, 0, 0] }]\n", "a"),
            "s.toml:50:43: 'left' is 'held' and has no velocity");
  EXPECT_EQ(refusal(a + "until = { probe = \"grip\", above = 1 }\n", "a"),
            "s.toml:50:19: unknown curve 'grip'");
  EXPECT_EQ(refusal(a + "until = { probe = \"grip.force_x\", above = 1, below = 2 }\n", "a"),
            "s.toml:50:54: give 'above' or 'below', not both");
  EXPECT_EQ(refusal(a + "until = { probe = \"grip.force_x\" }\n", "a"),
            "s.toml:50:9: missing key 'above' in 'stage.until'");
  EXPECT_EQ(refusal(a + "probe_every = 0\nuntil = { probe = \"grip.force_x\", above = 1 }\n", "a"),
            "s.toml:40:1: 'until' needs readings: 'probe_every' is 0");
  EXPECT_EQ(refusal(kRamps, "start"), "s.toml has no stage 'start'");
  const std::string ramp =
      "constraint = [{ name = \"right\", velocity = { from = [0, 0, 0], to = [1, 0, 0] } }]\n";
  EXPECT_EQ(refusal(a + ramp, "a"),
            "s.toml:50:44: a ramp needs 'parts' in its stage: of how many constant values it is made");
  EXPECT_EQ(refusal(a + "parts = 1\n" + ramp, "a-1"),
            "s.toml:50:9: 'parts' must be between 2 and 100, not 1");
  EXPECT_EQ(refusal(a + "parts = 2\n", "a-1"), "s.toml:50:9: 'parts' serves ramps, and the stage has none");
  EXPECT_EQ(refusal(a + "parts = 2\n" + ramp + "[[stage]]\nname = \"a-2\"\n", "a-1"),
            "s.toml:53:8: stage 'a-2' is there twice");
  EXPECT_EQ(refusal(a + "parts = 2\ngravity = { from = [0, 0, 0], too = [0, 0, 1] }\n", "a-1"),
            "s.toml:51:31: unknown key 'too'");
  EXPECT_EQ(refusal(a + "parts = 2\nconstraint = [{ name = \"left\", velocity = { from = [0, 0, 0], to = [1, "
                        "0, 0] } }]\n",
                    "a-1"),
            "s.toml:51:43: 'left' is 'held' and has no velocity");
  EXPECT_EQ(refusal("[start]\nform = \"out\"\n", ""), "s.toml:49:1: unknown key 'form'");
  EXPECT_EQ(parsed("[start]\nfrom = \"out\"\n", "").start, "out");
}

// Who does not put particles where another run left them must not take such a scene for another one.
TEST(Stage, IsForThoseWhoBeginElsewhere) {
  const auto plain = [](const std::string& more) {
    try {
      parse_scene(read_config_text(kGrips) + "\n" + more, "s.toml");
    } catch (const InputError& error) {
      const std::string what = error.what();
      return what.substr(0, what.find('\n'));
    }
    return std::string();
  };
  EXPECT_EQ(plain(""), "");
  EXPECT_EQ(plain(kStages),
            "s.toml:49:1: a scene of stages is for 'cuboct run', 'crosscheck', 'check' and 'emit'");
  EXPECT_EQ(plain("[start]\nfrom = \"out\"\n"),
            "s.toml:48:1: [start] is for 'cuboct run', 'crosscheck', 'check' and 'emit'");
}

}  // namespace
}  // namespace cuboct
