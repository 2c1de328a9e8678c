// SPDX-License-Identifier: MIT
// A rule's text with `core` is a pair law: the same integers as [law] has, on every scene that has one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "model/base/error.h"
#include "model/base/output.h"
#include "model/contract/law.h"
#include "model/contract/law_function.h"
#include "model/contract/pair_program.h"
#include "model/contract/quantise.h"
#include "model/graph/certificate.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

const std::string kScenes = CUBOCT_SOURCE_DIR "/scenes/";

// The scene's text with another [law].
std::string with_law(const std::string& scene, const std::string& law) {
  static const std::regex table("\\[law\\][^\\n]*\\n(?:[^\\[\\n][^\\n]*\\n|\\n)*");
  const std::string text = read_text(kScenes + scene);
  const std::string made = std::regex_replace(text, table, law + "\n");
  EXPECT_NE(made, text) << scene << " has no [law]";
  return made;
}

Scene scene_with(const std::string& scene, const std::string& law) {
  return parse_scene(with_law(scene, law), kScenes + "test.toml");
}

// All that golden computes with.
std::string integers_of(const Scene& scene) {
  const FixedRule fixed = quantise(scene.rule, 1.25 * scene.rule.cutoff(), {}, {}, 1e-3);
  return graph::certificate_of(pair_program(fixed, 16));
}

void expect_same(const Scene& law, const Scene& text) {
  ASSERT_EQ(law.body.x, text.body.x);
  EXPECT_EQ(law.body.v, text.body.v);
  EXPECT_EQ(law.rule.dt, text.rule.dt);
  EXPECT_EQ(integers_of(law), integers_of(text));
}

struct Bond {
  const char *scene, *kind, *stiffness;
};
class PairText : public testing::TestWithParam<Bond> {};

TEST_P(PairText, HasTheIntegersOfItsLaw) {
  const Bond& bond = GetParam();
  expect_same(
      scene_with(bond.scene,
                 fmt::format("[law]\nkind = \"{}\"\nstiffness = \"{}\"\n", bond.kind, bond.stiffness)),
      scene_with(bond.scene,
                 fmt::format("[rule]\nfile = \"rules/texts/{}.toml\"\nparameters.stiffness = \"{}\"\n",
                             bond.kind, bond.stiffness)));
}

INSTANTIATE_TEST_SUITE_P(Scenes, PairText,
                         testing::Values(Bond{"coupon.toml", "ductile", "1.3 MN/m"},
                                         Bond{"templates/beam.toml", "elastic", "5 kN/m"},
                                         Bond{"plate.toml", "brittle", "900 N/m"},
                                         Bond{"templates/impact.toml", "viscous", "7 MN/m"},
                                         Bond{"templates/sheet.toml", "brittle", "1.1 MN/m"}),
                         [](const auto& test) {
                           return std::regex_replace(std::string(test.param.scene), std::regex("[^a-z]"),
                                                     "_");
                         });

TEST(PairText, HasTheIntegersOfLennardJones) {
  for (const char* end : {"", "_shifted"}) {
    const std::string numbers =
        "epsilon = \"0.4093 eV\"{0} sigma = \"2.338 angstrom\"{0} cutoff = \"5.5 angstrom\"";
    const std::string law =
        fmt::format("[law]\nkind = \"lj\"\n{}\n{}", fmt::format(fmt::runtime(numbers), "\n"),
                    *end ? "smooth = \"linear\"\n" : "");
    const std::string text = fmt::format("[rule]\nfile = \"rules/texts/lj{}.toml\"\nparameters = {{ {} }}\n",
                                         end, fmt::format(fmt::runtime(numbers), ","));
    expect_same(scene_with("templates/metal.toml", law), scene_with("templates/metal.toml", text));
  }
}

std::string argon(const std::string& rule, const char* pitch) {
  return fmt::format("mass = \"40 u\"\npacking = {{ pitch = \"{}\" }}\n", pitch) +
         "box = { cells = [4, 4, 4], periodic = \"xyz\" "
         "}\n"
         "run = { dt = \"2 fs\", steps = 10 }\n" +
         rule;
}
Scene scene_of(const std::string& rule, const char* pitch = "relaxed") {
  return parse_scene(argon(rule, pitch), kScenes + "test.toml");
}

const std::string kLaw =
    "[law]\nkind = \"lj\"\nepsilon = \"10.3 meV\"\nsigma = \"3.405 angstrom\"\ncutoff = \"8.5 angstrom\"\n";
const std::string kText = "[rule]\nfile = \"rules/texts/lj.toml\"\n";

TEST(PairText, HasForceSlopeAndEnergyOfTheLaw) {
  const Scene law = scene_of(kLaw), text = scene_of(kText);
  EXPECT_EQ(law.pitch, text.pitch);
  const PairLaw &a = *law.rule.law, &b = *text.rule.law;
  const double depth = 10.3e-3 * 1.602176634e-19;
  for (int k = 1; k < 1000; ++k) {
    const double r = a.cutoff() * k / 990;
    EXPECT_EQ(a.force(r), b.force(r)) << r;
    EXPECT_NEAR(a.slope(r), b.slope(r), 1e-13 * std::abs(a.slope(r))) << r;
    EXPECT_NEAR(a.energy(r), b.energy(r), 2e-12 * depth + 1e-12 * std::abs(a.energy(r))) << r;
  }
}

// Of one rounding each: the law divides r^2, the text has r.
TEST(PairText, MovesTheReferenceAsTheLawDoes) {
  Scene law = scene_of(kLaw), text = scene_of(kText);
  law.body.x[0][0] += 2e-11, text.body.x[0][0] += 2e-11;
  Reference of_law(law.rule, law.body, law.periodic), of_text(text.rule, text.body, text.periodic);
  of_law.step(50), of_text.step(50);
  for (size_t i = 0; i < law.body.size(); ++i)
    EXPECT_LT((of_law.body().x[i] - of_text.body().x[i]).norm(), 1e-22) << i;
}

// What a charge feels of another whose far field is screened: D. Wolf, P. Keblinski, S. R. Phillpot and J.
// Eggebrecht, J. Chem. Phys. 110 (1999) 8254, equation 4.4. An [energy] of another slope would be refused.
TEST(PairText, KnowsTheErrorFunctionAndItsSlope) {
  const Scene scene = scene_of(
      "[rule]\nname = \"screened\"\nreach = \"8 angstrom\"\ncore = \"2 angstrom\"\n"
      "parameters = { charges = \"14.4 eV*angstrom\", screen = \"0.2 1/angstrom\" }\n"
      "round = [ { sum.force = \"-charges * (erfc(screen * r) / r^2 + 2 * screen / sqrt(pi) * exp(-(screen * "
      "r)^2) / r) * "
      "(d / r)\" } ]\nenergy.pair = \"charges * erfc(screen * r) / r\"\n",
      "5 angstrom");
  const PairLaw& law = *scene.rule.law;
  const double angstrom = 1e-10, charges = 14.4 * 1.602176634e-19 * angstrom, screen = 0.2 / angstrom;
  const auto energy = [&](double r) { return charges * std::erfc(screen * r) / r; };
  for (double r = 2.1 * angstrom; r < 7.9 * angstrom; r += 0.1 * angstrom) {
    const double h = 1e-4 * angstrom, force = (energy(r - h) - energy(r + h)) / (2 * h);
    EXPECT_NEAR(law.force(r), force, 1e-7 * force) << r;
    const double slope = (law.force(r + h) - law.force(r - h)) / (2 * h);
    EXPECT_NEAR(law.slope(r), slope, 1e-7 * std::abs(slope)) << r;
  }
}

TEST(PairText, IsALawOfAPairOfMaterials) {
  const Scene scene = read_scene(kScenes + "rules/pair.toml");
  ASSERT_EQ(scene.rule.laws(), 3U);
  EXPECT_EQ(scene.rule.law_at(0).form(), preset_law("elastic", 0.5e-3, 159e3)->form());
  EXPECT_EQ(scene.rule.law_at(1).form(), preset_law("ductile", 0.5e-3, 1.59e6)->form());
  EXPECT_EQ(scene.rule.law_at(2).form(), preset_law("brittle", 0.5e-3, 159e3)->form());
  EXPECT_EQ(scene.rule.strength[0][1], 0.5);
}

std::string refusal(const std::string& rule) {
  return refused_with([&] { scene_of(rule, "5 angstrom"); });
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(PairText, IsNoMoreThanAPairLaw) {
  const std::string head = "[rule]\nreach = \"8 angstrom\"\ncore = \"3 angstrom\"\n";
  const auto expect = [&](const std::string& rest, const std::string& what) {
    const std::string said = refusal(head + rest);
    EXPECT_TRUE(has(said, what) && has(said, "test.toml:")) << rest << said;
  };
  const std::string round = "[[rule.round]]\n", spring = "sum.force = \"(r - 5 angstrom) * 1 N/m * d / r\"\n";
  EXPECT_EQ(refusal(head + round + spring), "accepted");
  expect("particle.E = { unit = \"J\" }\n" + round + spring, "has no fields");
  expect("still = true\n" + round + "sum.a = \"r\"\n", "which moves particles");
  expect(round + spring + "finish.force = \"2 * force\"\n", "has the sum 'force' alone");
  expect(round + "sum.a = \"r\"\n" + round + spring, "of one round");
  expect(round + "sum.force = { is = \"1 N/m * d\", when = \"r < 5 angstrom\" }\n", "wherever r is below");
  expect(round + "sum.force = \"1 N/m * d + 1 kg/s * (v_j - v_i)\"\n", "d times a function of r");
  expect(round + "sum.force = \"[1 N/m * d.x, 2 N/m * d.y, 1 N/m * d.z]\"\n", "d times a function of r");
  expect(round + "sum.force = \"1 N/m * d * sqrt((4 angstrom - r) / reach)\"\n", "is no number");
  expect("energy.pair = \"0.4 N/m * (r - 5 angstrom)^2\"\n" + round + spring, "the energy falls by");
  EXPECT_EQ(refusal(head + "energy.pair = \"0.5 N/m * (r - 5 angstrom)^2\"\n" + round + spring), "accepted");
  const std::string far = "[rule]\nreach = \"8 angstrom\"\ncore = \"9 angstrom\"\n" + round + spring;
  EXPECT_TRUE(has(refusal(far), "not below 'reach'")) << refusal(far);
}

// Where the root is flat so is the force; an energy that is no number is not the force's.
TEST(PairText, HasASlopeWhereARootEnds) {
  const std::string head = "[rule]\nreach = \"8 angstrom\"\ncore = \"3 angstrom\"\n";
  const std::string rest =
      "[[rule.round]]\nsum.force = \"-1 N/m * reach * sqrt(max(0, 0.51 - r / reach)) * d / r\"\n";
  const Scene scene = scene_of(head + rest, "5 angstrom");
  EXPECT_EQ(scene.rule.law->slope(7e-10), 0);
  EXPECT_LT(scene.rule.law->slope(4e-10), 0);
  const std::string none =
      refusal(head + "energy.pair = \"1 J * sqrt(min(r - 9 angstrom, 0 m) / reach)\"\n" + rest);
  EXPECT_TRUE(has(none, "the energy falls by")) << none;
}

TEST(PairText, OfALawFindsThePitchWithoutPressure) {
  const Scene law = scene_of(kLaw),
              text = scene_of("[law]\nkind = \"rule\"\nfile = \"rules/texts/lj.toml\"\n");
  EXPECT_EQ(law.pitch, text.pitch);
}

TEST(PairText, RefusesTablesThatAreNone) {
  const auto expect = [&](const std::string& table, const std::string& what) {
    const std::string said =
        refusal("[rule]\nreach = \"8 angstrom\"\ncore = \"3 angstrom\"\n[rule.table.f]\n" + table +
                "[[rule.round]]\nsum.force = \"-f(r) * (d / r)\"\n");
    EXPECT_TRUE(has(said, what)) << table << said;
  };
  const std::string at = "at = [\"3 angstrom\", \"5 angstrom\", \"reach\"]\n",
                    value = "value = \"[1, 0, 0] pN\"\n";
  expect(at + value, "accepted");
  expect("at = \"[3, 5, 8] angstrom\"\n" + value, "accepted");
  expect(at + value + "slope = [0, \"-1 N/m\", 0]\n", "accepted");
  expect("at = \"[3, 5, 5] angstrom\"\n" + value, "must ascend, but point 3 does not");
  expect(at + "value = \"[1, 0] pN\"\n", "'at' has 3 points, 'value' has 2");
  expect(at + value + "slope = [0, 1, 0]\n", "a slope must be");
  expect("at = [\"3 angstrom\", \"5 s\", \"reach\"]\n" + value, "this is");
  expect("at = \"3 angstrom\"\nvalue = \"1 pN\"\n", "two points at least");
  expect(at + "value = [\"1 pN\", \"1 pN / 0\", 0]\n", "finite constants");
  const std::string taken =
      "[rule]\nreach = \"8 angstrom\"\ntable.sqrt = { at = [0, 1], value = [0, 1] }\n"
      "[[rule.round]]\nsum.force = \"1 N/m * d\"\n";
  EXPECT_TRUE(has(refusal(taken), "the name 'sqrt' is taken")) << refusal(taken);
  const std::string pair =
      "[rule]\nreach = \"cutoff\"\npotential.file = \"rules/texts/copper.eam.alloy\"\n"
      "table.pair = { at = [0, 1], value = [0, 1] }\n"
      "[[rule.round]]\nsum.force = \"1 N/m * d\"\n";
  EXPECT_TRUE(has(refusal(pair), "the name 'pair' is taken")) << refusal(pair);
}

}  // namespace
}  // namespace cuboct
