// SPDX-License-Identifier: MIT
// Scenes with [rule], and the engine that runs them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/analysis/motion.h"
#include "model/base/error.h"
#include "model/real/reference.h"
#include "model/rules/rounds_rule.h"
#include "model/run/rounds_run.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

std::string scene_with(const std::string& rule, const std::string& more = "") {
  return "density = \"2440 kg/m^3\"\npacking = { pitch = \"1 mm\" }\n"
         "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[8, 8, 4] mm\" }\n"
         "[rule]\nkind = \"lps\"\nyoungs_modulus = \"72 GPa\"\npoissons_ratio = 0.22\n" +
         rule + more + "[run]\ndt = \"auto\"\nsteps = 40\n";
}

const std::string kPulled =
    "[[velocity]]\nregion = { shape = \"half_space\", point = \"[0, 4.1, 0] mm\", normal = \"y\" }\n"
    "uniform = \"[0, 40, 3] m/s\"\n";

Body after(const Scene& scene, uint64_t steps, int threads) {
  RoundsRun run(scene, scene.body, RealOptions{.threads = threads}, 1e-3);
  run.advance(steps, nullptr);
  return *run.saved_body();
}

TEST(LpsScene, NoBitDependsOnThreads) {
  const Scene scene = parse_scene(scene_with("fracture_energy = \"3.8 J/m^2\"\n", kPulled), "plate");
  const Body one = after(scene, 40, 1), three = after(scene, 40, 3);
  ASSERT_GT(one.size(), 200u);
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one.x[i], three.x[i]) << i;
    EXPECT_EQ(one.v[i], three.v[i]) << i;
  }
}

// With what its bonds kept, a run in two parts is the run in one; where they count from there, or without
// what they kept, it is not.
TEST(LpsScene, ARunInTwoPartsIsTheRunInOne) {
  const Scene scene =
      parse_scene(scene_with("fracture_energy = \"3.8 J/m^2\"\ndamage_width = 1e-5\n", kPulled), "plate");
  const Body whole = after(scene, 40, 1);
  RoundsRun first(scene, scene.body, {}, 1e-3);
  first.advance(25, nullptr);
  const Body half = *first.saved_body();
  const auto rest = [&](const std::shared_ptr<const BondState>& bonds) {
    Body begin = half;
    begin.bonds = bonds;
    RoundsRun second(scene, begin, {}, 1e-3, 25);
    second.advance(15, nullptr);
    return *second.saved_body();
  };
  const Body kept = rest(half.bonds), moved = rest(nullptr);
  const Body healed = rest(std::make_shared<BondState>(BondState{scene.body.x, {}}));
  double apart = 0, away = 0;
  for (size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(whole.x[i], kept.x[i]) << i;
    apart = std::max(apart, (whole.x[i] - healed.x[i]).norm());
    away = std::max(away, (whole.x[i] - moved.x[i]).norm());
  }
  EXPECT_EQ(whole.bonds->kept, kept.bonds->kept);
  EXPECT_GT(apart, 0);
  EXPECT_GT(away, 0);
}

// Undamaged and free: momentum is kept to rounding, and energy to the order of the step squared.
TEST(LpsScene, MomentumAndEnergyAreKept) {
  const Scene scene =
      parse_scene(scene_with("",
                             "[[velocity]]\nuniform = \"[0, 0, 0.1] m/s\"\n"
                             "region = { shape = \"half_space\", point = \"[4, 0, 0] mm\", normal = "
                             "\"x\" }\n"),
                  "plate");
  RoundsRun run(scene, scene.body, {}, 1e-3);
  Asked asked;
  asked.energies = true;
  const Vec3 momentum = run.momentum().real;
  const double energy = run.read(asked).energies.total();
  EXPECT_GT(energy, 0);
  run.advance(400, nullptr);
  EXPECT_LT((run.momentum().real - momentum).norm(), 1e-12 * momentum.norm());
  EXPECT_NEAR(run.read(asked).energies.total() / energy, 1, 0.02);
}

// The limit is that of the packing: above it a free block flies apart, below it does not.
TEST(LpsScene, TheStableStepIsThatOfTheLattice) {
  const Scene scene = parse_scene(scene_with(""), "plate");
  const auto grows = [&](double part) {
    Scene one = scene;
    one.rule.dt = part * scene.dt_limit;
    for (size_t i = 0; i < one.body.size(); ++i)
      one.body.v[i] = 1e-3 * Vec3(std::sin(7.1 * i), std::sin(3.3 * i), std::sin(1.7 * i));
    RoundsRun run(one, one.body, {}, 1e-3);
    try {
      run.advance(600, nullptr);
    } catch (const StepError&) {
      return true;
    }
    return run.largest_speed() * 1e-3 / one.rule.dt > 1;  // m/s
  };
  EXPECT_FALSE(grows(0.9));
  EXPECT_TRUE(grows(1.2));
}

// What a scene says of its motion: long pressure waves run at sqrt(E (1 - nu)/((1 + nu)(1 - 2 nu) density)).
TEST(LpsScene, WavesAreThoseOfTheSolid) {
  const Motion motion = motion_of(parse_scene(scene_with("", kPulled), "plate"));
  EXPECT_NEAR(motion.sound_speed, std::sqrt(72e9 * 0.78 / (1.22 * 0.56 * 2440)), 1e-6);
  EXPECT_EQ(motion.rest_distance, 1e-3);
  EXPECT_GT(motion.strain, 1e-3);
}

std::string refusal(const std::string& text) {
  return refused_with([&] { parse_scene(text, "s.toml"); });
}

TEST(LpsScene, WhatCannotBeIsRefusedAtItsKey) {
  const auto has = [](const std::string& text, const std::string& place, const std::string& what) {
    const std::string said = refusal(text);
    EXPECT_TRUE(said.starts_with(place)) << said;
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  has(scene_with("horizon = \"0.5 mm\"\n"), "s.toml:4:1", "no neighbour is within the horizon");
  has(scene_with("horizon = \"1 m\"\n"), "s.toml:8:11", "'horizon' must be above 0 and at most ");
  has(scene_with("surface_correction = true\n"), "s.toml:4:1", "one of small displacements");
  has(scene_with("damage_width = 1e-4\n"), "s.toml:8:1", "of bonds that break");
  has(scene_with("critical_stretch = 0.1\nfracture_energy = \"1 J/m^2\"\n"), "s.toml:", "fracture_energy");
  has(scene_with("plane = \"stress\"\nvolume = \"1 mm^3\"\n"), "s.toml:8:9", "the body is not flat");
  has(scene_with("horizont = 3\n"), "s.toml:8:1", "unknown key 'horizont'");
  has(scene_with("", "[law]\nkind = \"elastic\"\nstiffness = \"1 N/m\"\n"), "s.toml:", "'law'");
  has(scene_with("", "[damping]\ncoefficient = \"1 kg/s\"\n"), "s.toml:", "damping");
  has(scene_with("", "[damping]\nratio = 0.1\n"), "s.toml:", "damping by pairs serves the pair law alone");
  has(scene_with("quadrature = \"fitted\"\nstrain = \"small\"\norder = 8\n"), "s.toml:10:9",
      "between 2 and 7");
  // No pair force says how stiff a holder would have to be.
  const std::string held =
      "[[constraint]]\nname = \"grip\"\nkind = \"held_by_force\"\nregion = { shape = \"sphere\", radius = "
      "\"1 m\" }\n";
  has(scene_with("", held), "s.toml:", "'kp'");
  EXPECT_EQ(refusal(scene_with("", held + "kp = \"1e3 N/m\"\n")), "accepted");
  EXPECT_EQ(refusal(scene_with("")), "accepted");
}

TEST(LpsScene, EnginesOfPairsRefuseIt) {
  const Scene scene = parse_scene(scene_with(""), "plate");
  ASSERT_NE(scene.rule.rounds.get(), nullptr);
  EXPECT_THROW(refuse_rounds(scene.rule, "the lattice engine"), InputError);
  EXPECT_THROW(RoundsRun(scene, scene.body, RealOptions{.precision = Precision::float32}, 1e-3), InputError);
}

TEST(LpsScene, PotentialEnergyOfTheReferenceIsTheRules) {
  const Scene scene = parse_scene(scene_with(""), "plate");
  Body body = scene.body;
  for (Vec3& x : body.x) x *= 1 + 1e-4;
  const Reference reference(scene.rule, scene.body, scene.periodic);
  EXPECT_EQ(reference.potential_energy(), 0);
  Reference moved(scene.rule, scene.body, scene.periodic);
  moved.place(body);
  EXPECT_GT(moved.potential_energy(), 0);
  EXPECT_GT(moved.virial_stress(1e-9)[0](0, 0), 0);
}

}  // namespace
}  // namespace cuboct
