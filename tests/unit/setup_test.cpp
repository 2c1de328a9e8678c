// SPDX-License-Identifier: MIT
// From scenes to plans: with and without a State in memory, and the cells that a body can reach.
#include "hw/plan/setup.h"

#include <gtest/gtest.h>

#include <functional>
#include <regex>

#include "model/base/error.h"
#include "model/config/config.h"
#include "model/scene/scene.h"

namespace cuboct {
namespace {

const std::string kTree = CUBOCT_SOURCE_DIR;

Scene example(const std::string& name) { return read_scene(kTree + "/scenes/" + name + ".toml"); }

std::string what_of(const InputError& error) { return error.what(); }

std::string error_of(const std::function<void()>& act,
                     const std::function<std::string(const InputError&)>& text = what_of) {
  try {
    act();
  } catch (const InputError& error) {
    return text(error);
  }
  return "no error";
}

TEST(Setup, APlanNeedsNoState) {
  for (const char* name : {"coupon", "lj_block", "two_types"}) {
    SCOPED_TRACE(name);
    const Scene scene = example(name);
    const cuboct::Setup setup = make_setup(scene, {});
    const Plan plan = plan_of(scene, {});
    EXPECT_EQ(plan.hash, setup.plan.hash);
    EXPECT_EQ(describe(plan), describe(setup.plan));
    ASSERT_EQ(plan.particles, setup.initial.particles.size());
    InitialParticles initial(scene.body, plan);
    for (uint32_t id = 0; id < plan.particles; ++id) ASSERT_EQ(initial(id), setup.initial.particles[id]);
  }
}

// A body of many blocks of what InitialParticles gives back.
TEST(Setup, ABodyIsUsedUpWithoutHarm) {
  const Scene scene = example("bench/block_256k");
  const cuboct::Setup setup = make_setup(scene, {});
  InitialParticles initial(scene.body, setup.plan);
  for (uint32_t id = 0; id < setup.plan.particles; ++id) ASSERT_EQ(initial(id), setup.initial.particles[id]);
}

TEST(Setup, BothWaysRefuseAlike) {
  Scene scene = example("undamped_block");
  Arch arch;
  arch.capacity = 3;
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }),
            "a cell would hold 4 particles: its capacity is 3\n"
            "  hint: set node.capacity to at least 4 in the arch file");
  EXPECT_EQ(error_of([&] { make_setup(scene, arch); }), error_of([&] { plan_of(scene, arch); }));
  arch.capacity = 300;
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }), "capacity = 300 is out of range: 1 to 256");
  EXPECT_EQ(error_of([&] { make_setup(scene, arch); }), error_of([&] { plan_of(scene, arch); }));
  arch.capacity = 16;
  arch.narrow_memories = true;
  const std::string port = "memories = \"narrow\" have one port to read: set ";
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }), port + "filter_lanes = 1");
  arch.filter_lanes = 1;
  EXPECT_EQ(error_of([&] { plan_of(scene, arch); }), port + "overlap = false");
  arch.overlap = false;
  EXPECT_NO_THROW(plan_of(scene, arch));
  scene.body.v[7][1] = 1e6;
  const std::string fast = error_of([&] { plan_of(scene, {}); });
  EXPECT_NE(fast.find("particle 7 moves at 1e+06 m/s: more than the "), std::string::npos) << fast;
  EXPECT_EQ(error_of([&] { make_setup(scene, {}); }), fast);
}

TEST(Setup, RefusesMachinesThatCannotUseHalosOnArrival) {
  const Scene scene = example("undamped_block");
  const auto refusal = [&](const std::string& node) {
    const Arch arch = parse_arch("name = \"a\"\n[node]\n" + node, "a.toml");
    return error_of([&] { plan_of(scene, arch); });
  };
  const auto expect = [&](const std::string& node, const std::string& message) {
    const std::string what = refusal(node);
    EXPECT_NE(what.find(message), std::string::npos) << what;
    EXPECT_TRUE(what.starts_with("a.toml:3:")) << what;
  };
  const std::string while_they_come = "halos = \"arrival\" are streamed while they come: set ";
  expect("halos = \"arrival\"\noverlap = false", while_they_come + "overlap = true");
  expect("halos = \"arrival\"\nbrick = [2, 1, 1]", while_they_come + "brick = [1, 1, 1]");
  expect("halos = \"arrival\"\nmemories = \"narrow\"\nfilter_lanes = 1\noverlap = false",
         while_they_come + "memories = \"wide\"");
  expect("streamers = 2\nforce_pipes = 2", "two streamers share the faces of halos used on arrival");
  expect("streamers = 2\nforce_pipes = 3\nhalos = \"arrival\"",
         "streamers = 2 with force_pipes = 3: each streamer feeds as many pipes");
  EXPECT_EQ(refusal("halos = \"arrival\"\nstreamers = 2\nforce_pipes = 2"), "no error");
}

// A refusal after the file was read stands at the key that it is about: the last line of `more`, column.
void expect_place(const std::string& more, const std::string& place, const std::string& message,
                  const std::string& arch = {}, const std::string& stage = {}) {
  const std::string grips = read_config_text(kTree + "/scenes/boards/grips.toml");
  const std::string text = more.starts_with('[') ? grips + more : more;
  const auto refused = [&] {
    plan_of(parse_scene(text, "s.toml", {.begins = true, .stage = stage}),
            parse_arch("name = \"a\"\n" + arch, "a.toml"));
  };
  const std::string what = error_of(refused), told = error_of(refused, &InputError::told);
  EXPECT_TRUE(what.starts_with(place + ": " + message)) << what;
  EXPECT_TRUE(std::regex_search(told, std::regex("\n +[0-9]+ \\| [^\n]+\n +\\| +\\^"))) << told;
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = read_config_text(kTree + "/scenes/boards/grips.toml");
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Setup, RefusalsStandAtTheirKeys) {
  const std::string widths = "[widths]\nposition_frac = 14\nguard = 4\n";
  // An imposed velocity: at the constraint's own key, not the first constraint's; of a stage at the stage's.
  expect_place(with("velocity = [0.03", "velocity = [90.03"), "s.toml:28:12", "an imposed velocity is ",
               widths);
  expect_place("[[stage]]\nname = \"a\"\nconstraint = [{ name = \"right\", velocity = [90, 0, 0] }]\n",
               "s.toml:49:44", "an imposed velocity is ", widths, "a");
  expect_place(with("mass = 1.0\n", "mass = 1.0\ngravity = [0, 0, -3e5]\n"), "s.toml:5:11", "gravity is ",
               widths);
  expect_place(with("kind = \"held\"", "kind = \"held_by_force\"\nkp = 1"), "s.toml:23:6", "the gain kp is ",
               "[widths]\ngain_frac = 24\n");
  // A law too strong for its bits: at the law, or at the material that makes it so.
  const std::string few = "[widths]\nstrength_bits = 8\nposition_frac = 14\nguard = 25\n";
  expect_place(with("stiffness = 1.0", "stiffness = 1.5"), "s.toml:15:13",
               "the pair law's f/r * dt^2/m reaches ", few);
  expect_place("[[material]]\nname = \"m\"\nstrength = 3\n", "s.toml:49:12",
               "the pair law's f/r * dt^2/m reaches ", few);
  expect_place(with("thermal_speed = 0.02\nseed = 1", "uniform = [0, 500, 0]"), "s.toml:31:1", "particle ");
  expect_place(with("cells = [2, 1, 1]", "size = [9.7, 4, 4]\nperiodic = \"x\""), "s.toml:11:8",
               "the packing does not repeat");
  expect_place(
      "[[material]]\nname = \"m\"\n[[material]]\nname = \"thin\"\nstrength = 1e-6\nregion = { shape = "
      "\"half_space\", point = [2.4, 0, 0], normal = [-1, 0, 0] }\n",
      "s.toml:51:12", "a pair strength is ");
  expect_place(
      "[[material]]\nname = \"m\"\n[[material]]\nname = \"n\"\nregion = { shape = \"half_space\", point = "
      "[2.4, 0, 0], normal = [-1, 0, 0] }\n[[bond]]\nbetween = [\"n\", \"m\"]\nstrength = 1e-6\n",
      "s.toml:54:12", "a pair strength is ");
  // Masses too far apart: at the heavy one's own, or at the one that it takes from the file.
  const std::string other =
      "[[material]]\nname = \"m\"\n[[material]]\nname = \"n\"\nregion = { shape = \"half_space\", point = "
      "[2.4, 0, 0], normal = [-1, 0, 0] }\n";
  expect_place(other + "mass = 1025\n", "s.toml:52:8", "a particle of 'n/right' is 1025 times as heavy");
  expect_place(with("mass = 1.0\n", "mass = 1025.0\n") + other + "mass = 1\n", "s.toml:4:8",
               "a particle of 'm");
  // A particle too fast: where it is given the most; what a constraint leads is given nothing.
  const std::string fast = "[[velocity]]\nuniform = [0, 500, 0]\n";
  expect_place("[[velocity]]\nuniform = [0, 0.1, 0]\n" + fast, "s.toml:49:1", "particle ");
  expect_place(
      "[[velocity]]\nuniform = [0, 9e9, 0]\nregion = { shape = \"half_space\", point = [0.4, 0, 0], "
      "normal = [1, 0, 0] }\n" +
          fast,
      "s.toml:50:1", "particle ");
  expect_place("[[velocity]]\nthermal_speed = 500\nseed = 2\n", "s.toml:47:1", "particle ");
  expect_place(
      "[[particle]]\nposition = [1.5, 1.5, 3]\nvelocity = [0.1, 0, 0]\n"
      "[[particle]]\nposition = [1.5, 1.5, 4]\nvelocity = [0, 0, 700]\n",
      "s.toml:52:12", "particle ");
  // The step grows with the mass, until no width holds what particles move in one.
  std::string heavy = with("mass = 1.0\n", "mass = 1e300\n");
  expect_place(heavy.replace(heavy.find("dt = 0.14"), 9, "dt = \"auto\""), "s.toml:41:6", "at 0.");
  // Of the machine: at the arch's.
  expect_place(with("steps = 24", "steps = 24 "), "a.toml:3:9", "brick = [8, 8, 8]",
               "[node]\nbrick = [8, 8, 8]\n");
  expect_place(with("steps = 24", "steps = 24 "), "a.toml:3:19", "difference_frac = 20 is out of range",
               "[widths]\ndifference_frac = 20\nposition_frac = 14\n");
}

}  // namespace
}  // namespace cuboct
