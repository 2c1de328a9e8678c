// SPDX-License-Identifier: MIT
#include "model/analysis/temperature.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "hw/engine/engine_kind.h"
#include "hw/engine/scene_engine.h"
#include "model/base/error.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

constexpr double kRounding = 2e-5;  // of a velocity of 1 m/s: 1e5 units of the default widths

// Particles of 2 kg too far from one another for any force; `particles`: positions and velocities.
std::string scene_of(const std::string& particles, const std::string& more = "") {
  return "title = \"gas\"\nunits = \"reduced\"\nmass = 2.0\n" + more +
         "[law]\nkind = \"lj\"\nepsilon = 1.0\nsigma = 1.0\ncutoff = 2.5\nsmooth = \"linear\"\n"
         "[run]\ndt = 0.001\nsteps = 1\n" +
         particles;
}
std::string particle(const std::string& position, const std::string& velocity) {
  return "[[particle]]\nposition = " + position + "\nvelocity = " + velocity + "\n";
}

struct Measured {
  const Curve* curve(const std::string& name) const {
    for (const Curve& one : curves)
      if (one.name == name) return &one;
    return nullptr;
  }
  std::vector<Curve> curves;
};
Measured at_start(const Scene& scene, const EngineKind& kind) {
  RunRequest request;
  request.energies = true;
  return {record(scene, kind, request).trace.curves};
}
Measured in_doubles(const Scene& scene) {
  const Plan plan = plan_of(scene, Arch());
  return at_start(scene, scene_reference_kind(scene, plan, {}));
}
Measured in_integers(const Scene& scene) {
  const Plan plan = plan_of(scene, Arch());
  return at_start(scene, golden_kind(scene, plan));
}

// About the mean (2, 0, 0) m/s: (1, 0, 0), (-1, 0, 0), (0, 3, 0), (0, -3, 0), so K = 2/2 (1 + 1 + 9 + 9) = 20
// J, and 3 (4 - 1) degrees of freedom, as the places differ along z: T = 40/9 J.
TEST(Temperature, IsThatOfTheMotionAboutTheMean) {
  const Scene scene =
      parse_scene(scene_of(particle("[0, 0, 0]", "[3, 0, 0]") + particle("[10, 0, 0]", "[1, 0, 0]") +
                           particle("[0, 10, 0]", "[2, 3, 0]") + particle("[0, 0, 10]", "[2, -3, 0]")),
                  "gas.toml");
  EXPECT_EQ(Thermometer(scene).degrees(), 9);
  for (const Measured& measured : {in_doubles(scene), in_integers(scene)}) {
    const Curve* curve = measured.curve("temperature");
    ASSERT_NE(curve, nullptr);
    EXPECT_EQ(curve->unit, "J");
    EXPECT_NEAR(curve->value[0], 40 / 9.0, kRounding * 40 / 9);
  }
}

// In the plane z = 0 nothing moves along z: 2 (4 - 1) degrees.
TEST(Temperature, CountsNoAxisAlongWhichNothingCanMove) {
  const Scene scene =
      parse_scene(scene_of(particle("[0, 0, 0]", "[3, 0, 0]") + particle("[10, 0, 0]", "[1, 0, 0]") +
                           particle("[0, 10, 0]", "[2, 3, 0]") + particle("[10, 10, 0]", "[2, -3, 0]")),
                  "gas.toml");
  EXPECT_EQ(Thermometer(scene).degrees(), 6);
  EXPECT_NEAR(in_integers(scene).curve("temperature")->value[0], 40.0 / 6, kRounding * 40 / 6);
}

// A particle that is held along x, and one that a controller moves: the three others make 2 + 3 + 3 - 3
// degrees, two of them along x with +-1 m/s about their mean.
TEST(Temperature, LeavesOutWhatIsHeldOrSteered) {
  const std::string hold =
      "[[constraint]]\nname = \"held\"\nkind = \"held\"\naxes = \"x\"\nregion = { shape = \"sphere\", radius "
      "= 1.0 }\n"
      "[[constraint]]\nname = \"led\"\nkind = \"moved_by_force\"\nvelocity = [7, 0, 0]\nkp = 1e4\nkd = 10.0\n"
      "region = { shape = \"sphere\", radius = 1.0, centre = [0, 0, 10] }\n";
  const Scene scene =
      parse_scene(scene_of(particle("[0, 0, 0]", "[0, 0, 0]") + particle("[10, 0, 0]", "[3, 0, 0]") +
                           particle("[0, 10, 0]", "[1, 0, 0]") + particle("[0, 0, 10]", "[9, 9, 9]")) +
                      hold,
                  "gas.toml");
  EXPECT_EQ(Thermometer(scene).degrees(), 5);
  for (const Measured& measured : {in_doubles(scene), in_integers(scene)})
    EXPECT_NEAR(measured.curve("temperature")->value[0], 2.0 * 2 / 5, kRounding);
}

TEST(Temperature, IsMeasuredInUndampedAndInHotScenesAlone) {
  const std::string two = particle("[0, 0, 0]", "[1, 0, 0]") + particle("[10, 0, 0]", "[0, 0, 0]");
  const std::string damped = "[damping]\ncoefficient = 0.1\n";
  const std::string hot = "[[velocity]]\nthermal_energy = 0.5\nseed = 1\n";
  EXPECT_TRUE(Thermometer(parse_scene(scene_of(two), "s.toml")).wanted());
  EXPECT_FALSE(Thermometer(parse_scene(scene_of(two + damped), "s.toml")).wanted());
  EXPECT_TRUE(Thermometer(parse_scene(scene_of(two + damped + hot), "s.toml")).wanted());
  EXPECT_FALSE(Thermometer(parse_scene(scene_of(particle("[0, 0, 0]", "[1, 0, 0]")), "s.toml")).wanted());
  EXPECT_EQ(in_doubles(parse_scene(scene_of(two + damped), "s.toml")).curve("temperature"), nullptr);
}

// What is heavier than a molecule stands for matter whose heat lies within it, unless the scene draws
// velocities; so do points of a peridynamic solid.
TEST(Temperature, IsOfMoleculesAlone) {
  const auto wanted = [](const std::string& mass, const std::string& more = "") {
    return Thermometer(
               parse_scene("mass = \"" + mass +
                               "\"\n[law]\nkind = \"lj\"\nepsilon = \"1e-21 J\"\nsigma = \"3 "
                               "angstrom\"\ncutoff = \"8 angstrom\"\n"
                               "[[particle]]\nposition = \"[0, 0, 0] angstrom\"\n[[particle]]\nposition = "
                               "\"[4, 0, 0] angstrom\"\n[run]\ndt = \"1 fs\"\nsteps = 1\n" +
                               more,
                           "s.toml"))
        .wanted();
  };
  EXPECT_TRUE(wanted("1e-25 kg"));
  EXPECT_TRUE(wanted("9e-21 kg"));
  EXPECT_FALSE(wanted("1.1e-20 kg"));
  EXPECT_FALSE(wanted("1e-6 kg"));
  EXPECT_TRUE(wanted("1e-6 kg", "[[velocity]]\nthermal_speed = \"1 m/s\"\nseed = 1\n"));
  EXPECT_FALSE(
      Thermometer(
          parse_scene(
              "density = \"2 g/cm^3\"\npacking = { pitch = \"4 angstrom\" }\n"
              "geometry = { shape = \"box\", size = \"[20, 20, 20] angstrom\" }\n[rule]\nkind = \"lps\"\n"
              "youngs_modulus = \"70 GPa\"\npoissons_ratio = 0.3\n[run]\ndt = \"auto\"\nsteps = 1\n",
              "glass.toml"))
          .wanted());
}

// 256 particles of kT = 0.2 J have 765 degrees: T is 0.2 J but for sqrt(2/765) = 5 % of scatter.
TEST(Temperature, OfADrawIsThatOfItsThermalEnergy) {
  const Scene scene = read_scene(std::string(CUBOCT_SOURCE_DIR) + "/scenes/lj_block.toml");
  EXPECT_EQ(Thermometer(scene).degrees(), 765);
  EXPECT_NEAR(in_integers(scene).curve("temperature")->value[0], 0.2, 4 * 0.05 * 0.2);
}

// A probe of the three near the origin: about their mean (2, 1, 0) m/s (1, -1, 0), (-1, -1, 0), (0, 2, 0), so
// K = 2/2 (2 + 2 + 4) = 8 J. The fourth is elsewhere, and makes the scene one in space: 3 (3 - 1) degrees.
std::string probed(const std::string& fourth, const std::string& more = "") {
  return scene_of(
      particle("[0, 0, 0]", "[3, 0, 0]") + particle("[10, 0, 0]", "[1, 0, 0]") +
      particle("[0, 10, 0]", "[2, 3, 0]") + fourth + more +
      "[[probe]]\nname = \"t\"\nkind = \"temperature\"\nregion = { shape = \"sphere\", radius = 12 }\n"
      "[[probe]]\nname = \"v\"\nkind = \"velocity\"\nregion = { shape = \"sphere\", radius = 12 }\n"
      "[[probe]]\nname = \"e\"\nkind = \"kinetic_energy\"\nregion = { shape = \"sphere\", radius = 12 }\n");
}
TEST(Temperature, ProbesMeasureARegion) {
  const auto expect = [](const std::string& text, double temperature, double energy) {
    const Scene scene = parse_scene(text, "gas.toml");
    for (const Measured& measured : {in_doubles(scene), in_integers(scene)}) {
      EXPECT_EQ(measured.curve("t.temperature")->unit, "J");
      EXPECT_NEAR(measured.curve("t.temperature")->value[0], temperature, 40 * kRounding);
      EXPECT_NEAR(measured.curve("e.kinetic_energy")->value[0], energy, 40 * kRounding);
      EXPECT_NEAR(measured.curve("v.velocity_x")->value[0], 2, kRounding);
      EXPECT_NEAR(measured.curve("v.velocity_y")->value[0], 1, kRounding);
      EXPECT_NEAR(measured.curve("v.velocity_z")->value[0], 0, kRounding);
    }
  };
  const double energy = 9 + 1 + 13;  // J, of 2 kg each, not about the mean
  expect(probed(particle("[0, 0, 20]", "[50, 0, 0]")), 2 * 8 / 6.0, energy);
  expect(probed(particle("[20, 20, 0]", "[50, 0, 0]")), 2 * 8 / 4.0, energy);  // a flat scene
  // What is held is no part of it: 2 kg at (0.5, -1.5) and (-0.5, 1.5) about their mean.
  const std::string held =
      "[[constraint]]\nname = \"a\"\nkind = \"moved\"\naxes = \"x\"\nvelocity = [3, 0, 0]\n"
      "region = { shape = \"sphere\", radius = 1 }\n";
  expect(probed(particle("[0, 0, 20]", "[0, 0, 0]"), held), 2 * 5 / 3.0, energy);
}

TEST(Temperature, NeedsTwoFreeParticles) {
  const std::string one =
      "[[probe]]\nname = \"a\"\nkind = \"temperature\"\n"
      "region = { shape = \"sphere\", radius = 1 }\n";
  const std::string two = particle("[0, 0, 0]", "[3, 0, 0]") + particle("[10, 0, 0]", "[1, 0, 0]");
  EXPECT_EQ(refused_with([&] { parse_scene(scene_of(two) + one, "a.toml"); }),
            "a.toml:22:10: a temperature needs two particles that no constraint holds or moves");
}

// Of copper at 300 K, and the same by its energy and its speed: kT = 4.14e-21 J, sqrt(kT/m) = 198 m/s.
TEST(Temperature, IsThatOfTheScene) {
  const auto copper = [](const std::string& thermal) {
    return parse_scene(
        "mass = \"63.546 u\"\n[packing]\npitch = \"relaxed\"\n[box]\nperiodic = \"xyz\"\ncells = [6, 6, 6]\n"
        "[law]\nkind = \"lj\"\nepsilon = \"0.409 eV\"\nsigma = \"2.338 angstrom\"\ncutoff = \"4.5 "
        "angstrom\"\n"
        "[[velocity]]\nseed = 1\n" +
            thermal + "\n[run]\nsteps = 1\n",
        "copper.toml");
  };
  const Scene scene = copper("temperature = \"300 K\"");
  EXPECT_NEAR(scene.rule.mass, 63.546 * 1.66053906660e-27, 1e-34);
  const Measured measured = in_doubles(scene);
  EXPECT_EQ(measured.curve("temperature")->unit, "K");
  EXPECT_NEAR(measured.curve("temperature")->value[0], 300, 4 * 300 * std::sqrt(2.0 / 2589));
  const double energy = 300 * 1.380649e-23;
  for (const std::string& same :
       {fmt::format("thermal_energy = \"{:.17g} J\"", energy),
        fmt::format("thermal_speed = \"{:.17g} m/s\"", std::sqrt(energy / scene.rule.mass))})
    for (size_t i = 0; i < scene.body.size(); ++i)
      ASSERT_LT((copper(same).body.v[i] - scene.body.v[i]).norm(), 1e-9) << same;
  // In reduced units a temperature is an energy.
  const std::string pair = particle("[0, 0, 0]", "[0, 0, 0]") + particle("[10, 0, 0]", "[0, 0, 0]");
  const std::string of = "[[velocity]]\nseed = 1\n";
  EXPECT_EQ(parse_scene(scene_of(pair + of + "temperature = 2\n"), "a.toml").body.v,
            parse_scene(scene_of(pair + of + "thermal_energy = 2\n"), "a.toml").body.v);
}

}  // namespace
}  // namespace cuboct
