// SPDX-License-Identifier: MIT
// Constraints of a constant force: what they are read as, Hooke's law, and the wave of a step.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "hw/plan/setup.h"
#include "model/base/error.h"
#include "model/base/steps.h"
#include "model/run/reference_engine.h"
#include "model/run/reference_kind.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

std::string pulled(const std::string& name, const std::string& what, const std::string& region) {
  return fmt::format("[[constraint]]\nname = \"{}\"\nkind = \"pulled\"\n{}\nregion = {}\n", name, what,
                     region);
}
std::string beyond(double x, const std::string& normal) {
  return fmt::format("{{ shape = \"half_space\", point = [{}, 0, 0], normal = \"{}\" }}", x, normal);
}

constexpr double kStiffness = 3, kPart = 3e-4;  // N on each of a bar's rows: a strain of 1e-4

// Rows of bonds along x, each with one particle in each end's region.
std::string bar(double force, const std::string& run) {
  return fmt::format(
             "units = \"reduced\"\nmass = 2.0\n[packing]\npitch = 1.0\naxes = [[1, 1, 0], [-1, 1, 0]]\n"
             "[geometry]\nshape = \"box\"\nsize = [8, 2.1, 2.1]\n[law]\nkind = \"elastic\"\nstiffness = {}\n",
             kStiffness) +
         pulled("left", fmt::format("force = [{}, 0, 0]", -force), beyond(-3.3, "x")) +
         pulled("right", fmt::format("force = [{}, 0, 0]", force), beyond(3.3, "-x")) + "[run]\ndt = 0.1\n" +
         run;
}

size_t count(const Scene& scene, const std::string& type) {
  size_t found = 0;
  for (const uint8_t k : scene.body.type) found += scene.rule.types[k].name == type ? 1 : 0;
  return found;
}

Recorded run_static(const Scene& scene) {
  RunRequest request;
  request.steps = scene.steps;
  request.frames = {0};
  return record(scene, scene_reference_kind(scene, scene.body, {}, 1), request);
}

// No bond is inclined under such a pull but those that stay as long as they were: each row carries its part
// F, and its bonds are stretched by F/k (docs/reference/physics.md, free surfaces). The two forces balance,
// so that the load by which the tolerance counts is one of them, not their sum.
TEST(Pulled, ABarIsStretchedAsHookeSays) {
  const Scene probe = parse_scene(bar(1, "steps = 10\n"), "bar");
  const auto rows = static_cast<double>(count(probe, "matter/right"));
  ASSERT_EQ(rows, count(probe, "matter/left"));
  ASSERT_GT(rows, 5);
  const Scene scene =
      parse_scene(bar(kPart * rows, "steps = 10\nstatic = { load_steps = 1, tolerance = 1e-7 }\n"), "bar");
  const Recorded run = run_static(scene);
  ASSERT_FALSE(run.trace.stop) << run.trace.stop->text;
  const std::vector<Vec3>& x = run.trace.bodies.back().x;
  double shift = 0;
  for (size_t i = 0; i < x.size(); ++i)
    shift += (x[i].x() - scene.body.x[i].x()) / static_cast<double>(x.size());
  const double strain = kPart / kStiffness;
  for (size_t i = 0; i < x.size(); ++i)
    // Second neighbours push by the square of the strain.
    EXPECT_NEAR(x[i].x() - scene.body.x[i].x() - shift, strain * scene.body.x[i].x(), 2e-3 * 4 * strain) << i;
}

TEST(Pulled, AForceWithoutACounterpartFindsNoRest) {
  const Scene scene =
      parse_scene(bar(1e-3,
                      "steps = 10\nstatic = { evaluations = 300 }\n[[stage]]\nname = \"one\"\n"
                      "constraint = [{ name = \"left\", free = true }]\n"),
                  "bar", {.begins = true, .stage = "one"});
  const Recorded run = run_static(scene);
  ASSERT_TRUE(run.trace.stop);
  EXPECT_NE(run.trace.stop->text.find("the load is 0.001 N; is a part of it free to fall or to drift?"),
            std::string::npos)
      << run.trace.stop->text;
}

// A bar without ends across, [100] along x: C11 = sqrt2 k/pitch, density sqrt2 m/pitch^3, so that waves go
// with c = pitch sqrt(k/m) = 1. Behind the front of a step of traction s, particles have the velocity s/(rho
// c).
constexpr double kTraction = 1.4142e-4, kRho = 1.41421356;
std::string wave() {
  return "units = \"reduced\"\nmass = 1.0\n[packing]\npitch = 1.0\n[box]\nperiodic = \"yz\"\ncells = [24, 3, "
         "3]\n"
         "[law]\nkind = \"elastic\"\nstiffness = 1.0\n" +
         pulled("face", fmt::format("traction = [{}, 0, 0]\narea = 18.0", kTraction), beyond(0.3, "x")) +
         "[[probe]]\nname = \"behind\"\nkind = \"velocity\"\naxis = \"x\"\n"
         "region = { shape = \"box\", min = [4, -9, -9], max = [16, 9, 9] }\n"
         "[run]\ndt = 0.05\nsteps = 500\nprobe_every = 500\n";
}

void expect_wave(const Scene& scene, const Recorded& run) {
  ASSERT_FALSE(run.trace.stop) << run.trace.stop->text;
  const double expected = kTraction / kRho;
  for (const Curve& curve : run.trace.curves)
    if (curve.name == "behind.velocity") {
      EXPECT_NEAR(curve.value.back(), expected, 0.01 * expected);
    }
  ASSERT_GT(run.trace.curves.size(), 0U);
  EXPECT_EQ(run.trace.curves[0].step.back(), scene.steps);
}

TEST(Pulled, AStepOfTractionSendsAWaveInAllEnginesOfTheFixedRule) {
  const Scene scene = parse_scene(wave(), "wave");
  const Plan plan = plan_of(scene, {});
  RunRequest request;
  request.steps = scene.steps;
  request.probes = every_so_often(scene.probe_every, scene.steps);
  request.frames = {0};
  const Recorded golden = record(scene, golden_kind(scene, plan), request);
  expect_wave(scene, golden);
  const Recorded lattice = record(scene, emu::lattice_kind(scene, plan, {}), request);
  expect_wave(scene, lattice);
  ASSERT_FALSE(golden.trace.state_hash.empty());
  EXPECT_EQ(golden.trace.state_hash.back(), lattice.trace.state_hash.back());
}

// All that a force gives is momentum: F t, whatever the bonds do with it.
TEST(Pulled, MomentumIsForceTimesTime) {
  const Scene scene = parse_scene(wave(), "wave");
  Reference reference(scene.rule, scene.body, scene.periodic);
  reference.step(200);
  EXPECT_NEAR(reference.momentum().x(), kTraction * 18 * 200 * 0.05, 1e-9 * kTraction * 180);
}

// Parts are equal whatever the masses, and only the particles that no later constraint takes have one.
TEST(Pulled, SharesItsForceAmongItsParticles) {
  const Scene scene = parse_scene(bar(6, "steps = 1\n") +
                                      "[[constraint]]\nname = \"stolen\"\nkind = \"held\"\nregion = { shape "
                                      "= \"box\", min = [3.3, -9, -9], max = "
                                      "[9, 9, -0.1] }\n[[material]]\nname = \"light\"\n[[material]]\nname = "
                                      "\"heavy\"\nmass = 6.0\nregion = "
                                      "{ shape = \"half_space\", point = [0, 0.1, 0], normal = \"-y\" }\n",
                                  "bar");
  Vec3 sum = Vec3::Zero();
  std::vector<double> parts;
  for (size_t i = 0; i < scene.body.size(); ++i) {
    const ParticleType& type = scene.rule.types[scene.body.type[i]];
    EXPECT_EQ(type.gravity, type.pull);
    if (type.name.find("/right") == std::string::npos) continue;
    parts.push_back(scene.rule.mass_of(scene.body.type[i]) * type.pull.x());
    sum += scene.rule.mass_of(scene.body.type[i]) * type.pull;
  }
  EXPECT_NEAR(sum.x(), 6, 1e-12);
  ASSERT_GT(count(scene, "light/right"), 0U);
  ASSERT_GT(count(scene, "heavy/right"), 0U);
  for (const double part : parts) EXPECT_NEAR(part, parts[0], 1e-12);
}

// A ramp is a staircase: the middle of its second part is 3/8 of the way.
TEST(Pulled, AStageChangesTheForceAndAddsGravity) {
  const std::string text = bar(2, "steps = 8\n") +
                           "[[stage]]\nname = \"up\"\nparts = 4\ngravity = [0, 0, -1]\nconstraint = [{ name "
                           "= \"right\", force = { from = [0, 0, 0], "
                           "to = [8, 0, 0] } }]\n";
  const Scene scene = parse_scene(text, "bar", {.begins = true, .stage = "up-2"});
  const auto n = static_cast<double>(count(scene, "matter/right"));
  for (const ParticleType& type : scene.rule.types) {
    const double x = type.name == "matter/right" ? 3 / n : type.name == "matter/left" ? -2 / n : 0;
    EXPECT_NEAR(type.pull.x(), x / 2, 1e-12) << type.name;  // over the mass
    EXPECT_EQ(type.gravity, type.pull + Vec3(0, 0, -1)) << type.name;
  }
}

TEST(Pulled, ErrorsAreAtTheirKeys) {
  const std::string region = beyond(3.3, "-x");
  const auto message = [&](const std::string& what, const std::string& more = "",
                           const std::string& stage = "") {
    return refused_with([&] {
      parse_scene(bar(1, "steps = 1\n") + pulled("third", what, region) + more, "bar.toml",
                  {.begins = true, .stage = stage});
    });
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_EQ(text.find("bar.toml:"), 0U) << text;
  };
  expect(message(""), "'force'");
  expect(message("force = [1, 0, 0]\ntraction = [1, 0, 0]"), "give 'force' or 'traction', not both");
  expect(message("traction = [1, 0, 0]"), "'area'");
  expect(message("traction = [1, 0, 0]\narea = 0.0"), "'area' must be");
  expect(message("force = [1, 0, 0]\narea = 2.0"), "unknown key 'area'");
  expect(message("force = [1, 0, 0]\nkp = 2.0"), "unknown key 'kp'");
  expect(message("force = [1, 0, 0]\naxes = \"x\""), "'axes' serves 'held' and 'moved' only, not 'pulled'");
  expect(message("force = [1, 0, 0]",
                 "[[constraint]]\nname = \"last\"\nkind = \"held\"\nregion = " + region + "\n"),
         "later constraints take all particles of this region");
  const auto staged = [&](const std::string& change) {
    return message("force = [1, 0, 0]",
                   "[[constraint]]\nname = \"still\"\nkind = \"held\"\nregion = " + beyond(-3.3, "x") + "\n" +
                       "[[stage]]\nname = \"a\"\nconstraint = [{ " + change + " }]\n",
                   "a");
  };
  expect(staged("name = \"third\", velocity = [1, 0, 0]"), "'third' has a 'force', which a stage may change");
  expect(staged("name = \"third\", traction = [1, 0, 0]"), "'third' has a 'force', which a stage may change");
  expect(staged("name = \"still\", force = [1, 0, 0]"), "'still' is 'held' and has no force");
  expect(staged("name = \"third\""), "a stage gives a constraint 'velocity', 'force', 'traction' or 'free'");
}

}  // namespace
}  // namespace cuboct
