// SPDX-License-Identifier: MIT
// The time step of a rule of text that does not say its stiffness.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "model/run/rounds_run.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

Scene timed_scene(const std::string& text) {
  return parse_scene(text, CUBOCT_SOURCE_DIR "/scenes/rules/test.toml");
}

// Springs between the 12 nearest neighbours of a crystal, mass 1 and stiffness 4 in reduced units. `more`: of
// the rule; `body`: its box.
std::string springs(const std::string& more = "",
                    const std::string& body = "box = { periodic = \"xyz\", cells = [4, 4, 4] }\n",
                    const std::string& force = "4 * (r - pitch) * d / r") {
  return "units = \"reduced\"\nmass = 1\npacking = { pitch = 1 }\n" + body +
         "run = { dt = \"auto\", steps = 10 }\n[rule]\nname = \"springs\"\nreach = \"1.2 * pitch\"\n" + more +
         "[[rule.round]]\nsum.force = \"" + force + "\"\n";
}

// The shortest waves of such a crystal have w^2 = 8 k/m.
TEST(StepLimit, OfSpringsIsThatOfTheShortestWave) {
  const Scene scene = timed_scene(springs());
  const double limit = 2 / std::sqrt(8 * 4.0);
  EXPECT_GE(scene.dt_limit, limit * (1 - 1e-6));
  EXPECT_LT(scene.dt_limit, limit * 1.03);
  EXPECT_EQ(scene.dt_limit_of, "the rule's forces at the start");
  EXPECT_NEAR(scene.rule.dt, 0.2 * scene.dt_limit, 1e-12);
  const Scene declared = timed_scene(springs("stiffness = 32\n"));
  EXPECT_DOUBLE_EQ(declared.dt_limit, limit);
  EXPECT_EQ(declared.dt_limit_of, "the perfect packing");
}

// 10,976 particles, of which the 4,000 nearest to the middle are taken.
TEST(StepLimit, OfALargeBodyIsThatOfItsMiddle) {
  const Scene scene = timed_scene(springs("", "box = { periodic = \"xyz\", cells = [14, 14, 14] }\n"));
  ASSERT_GT(scene.body.size(), 10000u);
  const double limit = 2 / std::sqrt(8 * 4.0);
  EXPECT_GE(scene.dt_limit, limit * (1 - 1e-6));
  EXPECT_LT(scene.dt_limit, limit * 1.05);
}

// The materials' middles are looked at, the light one's too: a quarter of the mass, half of the limit.
TEST(StepLimit, CountsTheLightestMaterial) {
  const std::string body =
      "box = { cells = [14, 14, 14] }\n"
      "material = [ { name = \"heavy\" }, { name = \"light\", mass = 0.25, region = { shape = "
      "\"half_space\", point = "
      "[2, 0, 0], normal = \"x\" } } ]\n";
  const Scene scene = timed_scene(springs("", body));
  const double limit = std::sqrt(0.25) * 2 / std::sqrt(8 * 4.0);
  EXPECT_GT(scene.dt_limit, limit * 0.98);
  EXPECT_LT(scene.dt_limit, limit * 1.25);  // a thin sheet of light particles on heavy ones
}

// Friction by the particle's own velocity: g = 10.
TEST(StepLimit, CountsFriction) {
  const std::string force = "4 * (r - pitch) * d / r";
  const Scene scene = timed_scene(springs("", "box = { periodic = \"xyz\", cells = [4, 4, 4] }\n") +
                                  "finish.force = \"force - 10 * mass * v\"\n");
  const double w2 = 8 * 4, g = 10, limit = (std::sqrt(g * g + 4 * w2) - g) / w2;
  EXPECT_GE(scene.dt_limit, limit * (1 - 1e-4));
  EXPECT_LT(scene.dt_limit, limit * 1.03);
}

// Noise over the root of dt, and what depends on dt, are looked at near the step that is taken.
TEST(StepLimit, IsThatOfTheForceWithNoise) {
  const Scene scene =
      timed_scene(springs() + "finish.force = \"force - 10 * mass * v + sqrt(20 / dt) * noises(1)\"\n");
  const double w2 = 8 * 4, g = 10, limit = (std::sqrt(g * g + 4 * w2) - g) / w2;
  EXPECT_GE(scene.dt_limit, limit * (1 - 1e-4));
  EXPECT_LT(scene.dt_limit, limit * 1.03);
}

std::string heat(const std::string& dt, const std::string& finish = "T + dt * 3 * gain") {
  return "units = \"reduced\"\nmass = 1\npacking = { pitch = 1 }\nbox = { periodic = \"xyz\", cells = [4, 4, "
         "4] }\n"
         "run = { dt = " +
         dt +
         ", steps = 10 }\n[rule]\nname = \"heat\"\nreach = \"1.2 * pitch\"\nstill = true\n"
         "[rule.particle.T]\nstart = \"300 + 100 * noise(1)\"\n"
         "[[rule.round]]\nsum.gain = \"T_j - T_i\"\nfinish.T = \"" +
         finish + "\"\n";
}

double most_different(double dt) {
  const Scene scene = timed_scene(heat(fmt::format("{:.17g}", dt)));
  RoundsRun run(scene, scene.body, {}, 1);
  run.advance(400, nullptr);
  double most = 0;
  const std::vector<double> values = run.shown().front().second;
  for (const double T : values) most = std::max(most, std::abs(T - 300));
  return most;
}

// 12 neighbours less the sum of 12 cosines is 16 at most: R = 48. Beyond the limit heat runs away.
TEST(StepLimit, OfHeatIsTheFieldsOwn) {
  const Scene scene = timed_scene(heat("\"auto\""));
  EXPECT_GE(scene.dt_limit, 2.0 / 48 * (1 - 1e-6));
  EXPECT_LT(scene.dt_limit, 2.0 / 48 * 1.03);
  EXPECT_EQ(scene.dt_limit_of, "the update of 'T' at the start");
  EXPECT_LT(most_different(0.95 * scene.dt_limit), 200);
  EXPECT_GT(most_different(1.1 * scene.dt_limit), 1e6);
}

// A step that suits waves at 1 m/s, and in which so slow a field changes by less than rounding.
TEST(StepLimit, OfASlowFieldOnAFinePackingIsTheFieldsOwn) {
  const auto oxygen = [](const std::string& pitch, const std::string& diffusivity) {
    return timed_scene(
        "density = \"7850 kg/m^3\"\npacking = { pitch = \"" + pitch +
        "\" }\nbox = { periodic = \"xyz\", cells = [4, 4, 4] }\nrun = { dt = \"auto\", steps = 10 }\n"
        "[rule]\nname = \"oxygen\"\nbonds = \"reference\"\nreach = \"1.2 * pitch\"\nstill = true\n"
        "[rule.parameters]\ndiffusivity = \"" +
        diffusivity +
        "\"\n[rule.particle.c]\nrange = [0, 1]\n[rule.let]\nrate = \"diffusivity / (2 * pitch^2)\"\n"
        "[[rule.round]]\nsum.flow = \"rate * (c_j - c_i)\"\nfinish.c = \"c + dt * flow\"\n");
  };
  const double slow = oxygen("1 um", "1e-13 m^2/s").dt_limit, coarse = oxygen("1 mm", "1e-7 m^2/s").dt_limit;
  // R = 16 D/(2 a^2), as of heat.
  EXPECT_GE(slow, 2 / 0.8 * (1 - 1e-6));
  EXPECT_LT(slow, 2 / 0.8 * 1.03);
  EXPECT_NEAR(slow, coarse, 1e-6 * slow);
  EXPECT_GT(oxygen("1 um", "1e-22 m^2/s").dt_limit, 2e9);
}

TEST(StepLimit, IsUnknownWhereNothingAnswers) {
  EXPECT_EQ(refused_with([] { timed_scene(heat("\"auto\"", "T + 0.01 * gain")); }), CUBOCT_SOURCE_DIR
            "/scenes/rules/test.toml:5:14: no stability limit is known for this scene: no field of the rule "
            "changes at a "
            "rate: by dt, and with what it is\n  hint: give 'dt'");
  const std::string none = refused_with(
      [] { timed_scene(springs("", "box = { periodic = \"xyz\", cells = [4, 4, 4] }\n", "[1, 0, 0]")); });
  EXPECT_NE(none.find("no stability limit is known for this scene: no force of the rule changes with where "
                      "particles are at "
                      "the start"),
            std::string::npos)
      << none;
}

// The tables of copper say what its text declares: eight springs of near neighbours, a twentieth nearer than
// rest.
TEST(StepLimit, OfCopperIsWithinWhatItsTextDeclares) {
  const std::string copper =
      "mass = \"63.546 u\"\npacking = { pitch = \"2.556191 angstrom\" }\nbox = { periodic = \"xyz\", cells = "
      "[5, 5, 5] }\n"
      "run = { dt = \"auto\", steps = 10 }\n[rule]\nfile = \"texts/eam.toml\"\npotential.file = "
      "\"texts/copper.eam.alloy\"\n";
  const Scene declared = timed_scene(copper);
  // The same text without its key.
  std::ifstream file(CUBOCT_SOURCE_DIR "/scenes/rules/texts/eam.toml");
  std::string eam((std::istreambuf_iterator<char>(file)), {});
  const size_t at = eam.find("stiffness = ");
  ASSERT_NE(at, std::string::npos);
  eam.erase(at, eam.find('\n', at) - at);
  const std::string path = testing::TempDir() + "eam_without_stiffness.toml";
  std::ofstream(path) << eam;
  const std::string rule = "texts/eam.toml";
  std::string other = copper;
  const Scene measured = timed_scene(other.replace(other.find(rule), rule.size(), path));
  EXPECT_GT(measured.dt_limit, declared.dt_limit);
  EXPECT_LT(measured.dt_limit, 2 * declared.dt_limit);
}

}  // namespace
}  // namespace cuboct
