// SPDX-License-Identifier: MIT
// Rules that are text, beside closed forms and beside the same rule written in C++.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "model/base/error.h"
#include "model/program/program_rule.h"
#include "model/real/rounds_engine.h"
#include "model/run/rounds_run.h"
#include "model/scene/scene.h"

namespace cuboct {
namespace {

const std::string kTexts = CUBOCT_SOURCE_DIR "/scenes/rules/";

Scene scene_of_text(const std::string& text) { return parse_scene(text, kTexts + "test.toml"); }

std::vector<double> field_in(RoundsRun& run, size_t index = 0) {
  return std::get<RealFrame>(run.frame(false)).shown[index];
}

// Everything but [rule], which is last.
std::string heat_bar(const std::string& rule) {
  return "density = \"7.8 g/cm^3\"\n"
         "packing = { pitch = \"1 mm\" }\n"
         "box = { periodic = \"yz\", cells = [11, 3, 3] }\n"
         "geometry = { shape = \"box\", min = \"[0, -9, -9] mm\", max = \"[14.2, 90, 90] mm\" }\n"
         "run = { dt = \"5 ms\", steps = 10 }\n" +
         rule;
}

const std::string kWave =
    "[rule]\nfile = \"texts/heat.toml\"\n"
    "start.T = \"300 K + 50 K * cos(pi * (x.x / pitch * sqrt(2) + 0.5) / 21)\"\n";

// Layers of (100) stand pitch/sqrt(2) apart. A particle has four bonds to each of the two layers beside its
// own, and those within its own exchange nothing here. With g = conductance/(heat capacity of a particle) =
// k/(2 c density pitch^2) the cosine of wave number q = pi/n over n layers, whose slope is 0 at the free
// ends, shrinks in a step by 1 - 8 g dt (1 - cos q).
TEST(Program, HeatOfABarDecaysAsTheClosedForm) {
  const Scene scene = scene_of_text(heat_bar(kWave));
  RoundsRun run(scene, scene.body, {}, 1e-3);
  const std::vector<double> first = field_in(run);
  ASSERT_NEAR(*std::ranges::max_element(first), 350 - 50 * (1 - std::cos(std::numbers::pi / 42)), 1e-9);
  constexpr int kSteps = 200;
  run.advance(kSteps, nullptr);
  const std::vector<double> last = field_in(run);
  const double g = 50 / (2 * 500 * 7800 * 1e-6), decay = 8 * g * 5e-3 * (1 - std::cos(std::numbers::pi / 21));
  double sum = 0;
  for (size_t i = 0; i < last.size(); ++i) {
    // Rounding: 200 sums of 12 terms of up to 350 K.
    EXPECT_NEAR(last[i] - 300, (first[i] - 300) * std::pow(1 - decay, kSteps), 1e-9) << i;
    sum += last[i] - first[i];
  }
  EXPECT_NEAR(sum, 0, 1e-8);
  EXPECT_LT(std::pow(1 - decay, kSteps), 0.9);
}

TEST(Program, NoBitDependsOnThreadsOrOnAPause) {
  const Scene scene = scene_of_text(heat_bar(kWave));
  const auto after = [&](int threads, uint64_t pause) {
    RoundsRun first(scene, scene.body, RealOptions{.threads = threads}, 1e-3);
    first.advance(pause, nullptr);
    const Body half = *first.saved_body();
    RoundsRun rest(scene, half, RealOptions{.threads = threads}, 1e-3, pause);
    rest.advance(40 - pause, nullptr);
    return field_in(rest);
  };
  const std::vector<double> whole = after(1, 0);
  EXPECT_EQ(whole, after(3, 0));
  EXPECT_EQ(whole, after(1, 17));
  RoundsRun start(scene, scene.body, {}, 1e-3);
  EXPECT_NE(whole, field_in(start));
}

std::string struck_block(const std::string& rule) {
  return "density = \"2440 kg/m^3\"\n"
         "packing = { pitch = \"1 mm\" }\n"
         "geometry = { shape = \"box\", min = \"[0, 0, 0] mm\", max = \"[8, 8, 4] mm\" }\n"
         "velocity = [ { region = { shape = \"half_space\", point = \"[0, 4.1, 0] mm\", normal = \"y\" }, "
         "uniform = \"[0, 40, 3] m/s\" } ]\n"
         "run = { dt = \"0.03 us\", steps = 60 }\n" +
         rule;
}

// Grips, and a slit that ends within the block.
const std::string kGripped =
    "[[rule.slit]]\ncorner = \"[-1, 2.1, -1] mm\"\nalong = \"[4, 0, 0] mm\"\nacross = \"[0, 0, 9] mm\"\n"
    "[regions]\ntop = { shape = \"half_space\", point = \"[0, 7, 0] mm\", normal = \"-y\" }\n"
    "bottom = { shape = \"half_space\", point = \"[0, 1, 0] mm\", normal = \"y\" }\n";
const std::string kTextOfGlass =
    "[rule]\nfile = \"texts/glass.toml\"\nparameters.fracture_energy = \"400 J/m^2\"\n";
const std::string kHard =
    "start.hard = \"inside_i(top) or inside_j(top) or inside_i(bottom) or inside_j(bottom)\"\n";

// The rule of scenes/rules/texts/glass.toml is that of [rule] kind = "lps", written by hand in C++: its
// critical stretch, its grips and its slit too.
TEST(Program, GlassIsThePeridynamicSolid) {
  const Scene text = scene_of_text(struck_block(kTextOfGlass + kHard + kGripped));
  const Scene own = scene_of_text(
      struck_block("[rule]\nkind = \"lps\"\nyoungs_modulus = \"70 GPa\"\npoissons_ratio = 0.22\n"
                   "fracture_energy = \"400 J/m^2\"\nunbreakable = [\"top\", \"bottom\"]\n" +
                   kGripped));
  RoundsRun a(text, text.body, {}, 1e-3), b(own, own.body, {}, 1e-3);
  Asked asked;
  asked.energies = true;
  asked.volume = 1e-9;
  for (int part = 0; part < 3; ++part) {
    a.advance(20, nullptr), b.advance(20, nullptr);
    const Body there = *a.saved_body(), here = *b.saved_body();
    for (size_t i = 0; i < here.size(); ++i) {
      const Vec3 moved = here.x[i] - own.body.x[i];
      // Both round sums of 18 terms, in doubles; the order of the products differs.
      EXPECT_LT((there.x[i] - here.x[i]).norm(), 1e-10 * (moved.norm() + 1e-6)) << i;
    }
    for (size_t i = 0; i < here.size(); ++i) EXPECT_NEAR(a.damage()[i], b.damage()[i], 1e-12);
    const Reading of_a = a.read(asked), of_b = b.read(asked);
    EXPECT_NEAR(of_a.energies.potential, of_b.energies.potential, 1e-9 * of_b.energies.potential);
    EXPECT_LT((of_a.stress - of_b.stress).norm(), 1e-9 * of_b.stress.norm());
  }
  double broken = 0;
  for (const double damage : a.damage()) broken += damage;
  EXPECT_GT(broken, 1) << "no bond broke: the test does not see what breaking does";
  // Grips and slit change what breaks.
  for (const std::string& without : {kHard, kGripped.substr(0, kGripped.find("[regions]"))}) {
    std::string rule = kTextOfGlass + kHard + kGripped;
    rule.erase(rule.find(without), without.size());
    const Scene other = scene_of_text(struck_block(rule));
    RoundsRun c(other, other.body, {}, 1e-3);
    c.advance(60, nullptr);
    EXPECT_NE(c.damage(), a.damage()) << without;
  }
}

double stiffness_of(const std::string& rule) {
  return scene_of_text(struck_block(rule)).rule.rounds->stiffness();
}

// The largest frequency of the text is a formula; that of kind "lps" is the largest on a grid of wave
// vectors, which lies some percent below the largest there is. Beyond a ratio of 0.4 the formula is the chord
// of a convex function, and up to a sixth above it.
TEST(Program, TheStiffnessOfGlassIsThatOfItsFastestWave) {
  for (const double ratio : {-0.4, 0.0, 0.22, 0.3, 0.4, 0.43, 0.46, 0.49}) {
    const double text = stiffness_of(
        fmt::format("[rule]\nfile = \"texts/glass.toml\"\nparameters.poissons_ratio = {}\n", ratio));
    const double own = stiffness_of(
        fmt::format("[rule]\nkind = \"lps\"\nyoungs_modulus = \"70 GPa\"\npoissons_ratio = {}\n", ratio));
    EXPECT_GT(text, own) << ratio;
    EXPECT_LT(text, own * (ratio > 0.4 ? 1.18 : 1.02)) << ratio;
  }
}

// Of an engine of doubles; tests/rules/integer_bonds_test.cpp has the same of integers.
TEST(Program, FramesAndProbesHaveTheDamage) {
  const Scene scene = scene_of_text(struck_block(
      "probe = [ { name = \"torn\", kind = \"field\", field = \"damage\", region = { shape = \"half_space\", "
      "point = \"[0, 0, 0] mm\", normal = \"-z\" } } ]\n" +
      kTextOfGlass));
  RoundsRun run(scene, scene.body, {}, 1e-3);
  run.advance(60, nullptr);
  const std::vector<double> damage = field_in(run, 1);
  EXPECT_EQ(damage, run.damage());
  EXPECT_EQ(run.shown().back().first, "damage");
  EXPECT_EQ(scene.probes.at(0).field_at, 1u);
  EXPECT_GT(*std::ranges::max_element(damage), 0.2);
  EXPECT_LT(*std::ranges::min_element(damage), 0.2);
}

// Values are SI, so what is told beside them is too, whatever unit the text's author likes.
TEST(Program, FieldsAreToldInSi) {
  const auto unit_of = [](const std::string& unit) {
    return scene_of_text(
               struck_block("probe = [ { name = \"near\", kind = \"field\", field = \"a\", region = "
                            "{ shape = \"sphere\", radius = \"1 m\" } } ]\n"
                            "[rule]\nreach = \"1.2 * pitch\"\n[rule.particle.a]\n" +
                            unit + "[[rule.round]]\nsum.force = \"0 N * d / r\"\n"))
        .probes.at(0)
        .unit;
  };
  EXPECT_EQ(unit_of("unit = \"eV\"\n"), "J");
  EXPECT_EQ(unit_of("unit = \"ug\"\n"), "kg");
  EXPECT_EQ(unit_of("unit = \"kJ/s\"\n"), "kg*m^2/s^3");
  EXPECT_EQ(unit_of("unit = \"N*s/m\"\n"), "N*s/m");
  EXPECT_EQ(unit_of(""), "1");
}

// One bond of two particles, pulled and pushed: its force is that of a spring in series with a slider.
TEST(Program, ASpringThatYieldsRemembers) {
  const Scene scene = scene_of_text(
      "mass = \"1 g\"\n"
      "box = { size = \"[9, 9, 9] mm\" }\n"
      "particle = [ { position = \"[1, 1, 1] mm\" }, { position = \"[2, 1, 1] mm\" } ]\n"
      "run = { dt = \"1 us\", steps = 10 }\n"
      "[rule]\nbonds = \"reference\"\nreach = \"2 mm\"\n"
      "[rule.bond.set]\nunit = \"m\"\n[[rule.round]]\n"
      "bond.set = \"max(min(set, r - r0 + 0.01 * r0), r - r0 - 0.01 * r0)\"\n"
      "sum.force = \"1 kN/m * (r - r0 - set) * d / r\"\n");
  Body body = scene.body;
  const auto engine = make_rounds_engine(scene.rule, with_bonds(scene.rule, body, body), {}, {});
  double set = 0;
  for (const double opening : {0.0, 5e-6, 1e-5, 3e-5, 2.5e-5, 0.0, -2e-5, 1e-6, 4e-5, 3.9e-5}) {
    body.x[1][0] = 2e-3 + opening;
    engine->place(body, 0);
    set = std::max(std::min(set, opening + 1e-5), opening - 1e-5);
    engine->give_way();
    EXPECT_NEAR(engine->forces()[0][0], 1e3 * (opening - set), 1e-9) << opening;
    EXPECT_EQ(engine->forces()[0][0], -engine->forces()[1][0]);
  }
}

// What is only looked at does not yield.
TEST(Program, ALookChangesNothing) {
  const Scene scene = scene_of_text(heat_bar(kWave));
  RoundsRun looked(scene, scene.body, {}, 1e-3), alone(scene, scene.body, {}, 1e-3);
  for (int k = 0; k < 5; ++k) {
    Asked asked;
    asked.energies = true;
    looked.read(asked);
    looked.advance(2, nullptr);
    alone.advance(2, nullptr);
  }
  EXPECT_EQ(field_in(looked), field_in(alone));
}

// With an evaluation of the rounds, for a field that they make, and without, for one that steps hand on.
TEST(Program, AReadingHasTheFieldsOfTheFrame) {
  for (const std::string& text : {heat_bar(kWave), struck_block("[rule]\nfile = \"texts/glass.toml\"\n")}) {
    const Scene scene = scene_of_text(text);
    RoundsRun read(scene, scene.body, {}, 1e-3), shown(scene, scene.body, {}, 1e-3);
    std::vector<uint32_t> ids(scene.body.size());
    std::iota(ids.begin(), ids.end(), 0);
    Asked asked;
    asked.ids = ids;
    asked.fields = true;
    std::vector<double> before;
    for (int k = 0; k < 3; ++k) {
      read.advance(7, nullptr), shown.advance(7, nullptr);
      const std::vector<double> fields = read.read(asked).fields[0];
      EXPECT_EQ(fields, field_in(shown));
      EXPECT_NE(fields, before);
      before = fields;
    }
  }
}

std::string text_refusal(const std::string& text) {
  try {
    parse_scene(text, kTexts + "s.toml");
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("/s.toml") == std::string::npos ? 0 : what.find("/s.toml") + 1);
  }
  return "none";
}

TEST(Program, WhatCannotBeIsRefusedAtItsPlace) {
  const auto has = [](const std::string& rule, const std::string& place, const std::string& what) {
    const std::string said =
        text_refusal(heat_bar("[rule]\nreach = \"1.2 * pitch\"\n" + rule));  // rule's line 7
    EXPECT_TRUE(said.starts_with("s.toml:" + place)) << said;
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  const std::string still = "still = true\n", round = "[[rule.round]]\n";
  has(still + round + "sum.a = \"b + 1\"\n", "10:10", "unknown name 'b'");
  has(still + round + "sum.a = \"1 + 2 K\"\n", "10:10", "'+' between a plain number and a temperature");
  has(still + round + "finish.T = \"1\"\n", "10:13", "no particle has a field 'T'");
  has(still + round + "sum.a = \"d\"\nsum.a2 = \"d *\"\n", "11:14", "the formula ends too early");
  has(still, "6:1", "a rule needs a [[round]]");
  has(round + "sum.a = \"d\"\n", "8:1", "the last round makes no force");
  has(round + "sum.force = \"d\"\n", "8:1", "must be a vector of newtons, not of a length");
  has(round + "bond.a = \"1\"\nsum.force = \"1 N * d / r\"\n", "9:11", "no bond has a field 'a'");
  has("bond.a.start = 1\n" + round + "sum.force = \"1 N * d / r\"\n", "8:1",
      "bonds of the moment hold nothing");
  has("particle.r.start = 1\n" + round + "sum.force = \"1 N * d / r\"\n", "8:10", "the name 'r' is taken");
  has("particle.a_i.start = 1\n" + round + "sum.force = \"1 N * d / r\"\n", "8:10",
      "ends as a particle's own");
  has("particle.a.start = \"1 K\"\n" + round + "sum.force = \"1 N * d / r\"\n", "8:21",
      "the start of 'a' must be a plain number, not a temperature");
  has("rule = 3\n" + round + "sum.force = \"1 N * d / r\"\n", "8:1", "unknown key 'rule'");
  const std::string pulled = "sum.force = \"1 N * d / r\"\n";
  const auto still_run = [&](const std::string& rule) {
    std::string text = heat_bar("[rule]\nreach = \"1.2 * pitch\"\n" + rule);
    return text_refusal(text.replace(text.find("steps = 10"), 10, "steps = 10, static = { load_steps = 2 }"));
  };
  EXPECT_NE(still_run(still + round + "sum.a = \"d\"\n").find("and the rule moves no particle"),
            std::string::npos);
  EXPECT_NE(still_run(round + pulled).find("does not say its stiffness"), std::string::npos);
  EXPECT_NE(still_run("particle.a.start = 1\n" + round + pulled + "finish.a = \"a + 1\"\n")
                .find("the rule's field 'a' goes on with it"),
            std::string::npos);
  EXPECT_EQ(still_run("stiffness = \"1 mN/m\"\n" + round + pulled), "none");
  const std::string file = "[rule]\nfile = \"texts/heat.toml\"\n";
  const auto of_file = [&](const std::string& more, const std::string& what) {
    EXPECT_NE(text_refusal(heat_bar(file + more)).find(what), std::string::npos)
        << text_refusal(heat_bar(file + more));
  };
  of_file("parameters.colour = 3\n", "s.toml:8:21: the rule has no parameter 'colour'");
  of_file("parameters.conductivity = \"3 m\"\n", "'conductivity' must be");
  of_file("start.U = 3\n", "the rule has no field 'U'");
  of_file("let.U = 3\n", "s.toml:8:9: the rule has no [let] name 'U'");
  of_file("start.T = \"select(inside(tip), 1 K, 2 K)\"\n[regions]\ntop = { shape = \"sphere\" }\n",
          "unknown region 'tip'");
  of_file("start.T = \"select(inside(1), 1 K, 2 K)\"\n", "'inside' takes the name of a region");
  of_file("start.T = \"select(inside_i(top), 1 K, 2 K)\"\n", "'inside_i' is not known here");
  of_file(kGripped.substr(0, kGripped.find("[regions]")), "bonds of the moment know no slit");
  const std::string nowhere =
      "[rule.start]\nT = \"select(inside(far), 1 K, 2 K)\"\n[regions]\nfar = { shape = "
      "\"sphere\", centre = \"[9, 9, 9] m\", radius = \"1 mm\" }\n";
  of_file(nowhere, "s.toml:11:7: no particle lies in this region");
  EXPECT_NE(text_refusal(heat_bar("rule = \"texts/none.toml\"\n")).find("no file 'texts/none.toml'"),
            std::string::npos);
}

}  // namespace
}  // namespace cuboct
