// SPDX-License-Identifier: MIT
// Rules that are text, in integers: golden beside the same text in doubles.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "model/graph/certificate.h"
#include "model/graph/parity.h"
#include "tests/rules/in_integers.h"

namespace cuboct {
namespace {

const std::string kHeatText = small_block("run = { dt = \"5 ms\", steps = 10 }\n") +
                              "[rule]\nfile = \"texts/heat.toml\"\n"
                              "start.T = \"300 K + 20 K/mm * x.x + 3 K/mm * x.y\"\n";

TEST(IntegerProgram, HeatIsThatOfDoublesAndItsSumIsKeptToTheLastBit) {
  const InIntegers made(kHeatText);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, 1e-3);
  const auto field = [](Engine& run) { return std::get<RealFrame>(run.frame(false)).shown[0]; };
  const std::vector<double> first = field(golden);
  // 46 bits for 2,000 K: a sum of 200 values is exact in doubles.
  const double sum = std::accumulate(first.begin(), first.end(), 0.0);
  golden.advance(300, nullptr), doubles.advance(300, nullptr);
  const std::vector<double> here = field(golden), there = field(doubles);
  double moved = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    // A step rounds each of 12 terms by 2^-36 K or so; differences keep 26 bits of 2,000 K: 3e-5 K, times
    // g dt = 0.03, and their errors diffuse.
    EXPECT_NEAR(here[i], there[i], 1e-4) << i;
    moved = std::max(moved, std::abs(here[i] - first[i]));
  }
  EXPECT_GT(moved, 10);
  EXPECT_EQ(std::accumulate(here.begin(), here.end(), 0.0), sum);
}

TEST(IntegerProgram, AResolutionIsTheCoarsestUnitOfAField) {
  const InIntegers made(kHeatText + "resolution.T = \"0.1 K\"\n");
  const graph::FixedProgram& program = made.program.program;
  ASSERT_EQ(program.fields.size(), 1u);
  EXPECT_EQ(program.fields[0].frac, 4);
  EXPECT_EQ(program.fields[0].range, (graph::Interval{-32768, 32767}));  // 2,000 K of 1/16 K
  EXPECT_EQ(graph::refusal_of(graph::certificate_of(program)).what, "");
  // The conductance is a factor of 16 bits.
  int64_t factor = 0;
  const std::vector<graph::Node>& nodes = program.rounds[0].pair.nodes;
  for (const graph::Node& node : nodes)
    for (const int k : node.op == graph::Op::mul ? node.inputs : std::vector<int>())
      if (const graph::Node& of = nodes[static_cast<size_t>(k)]; of.op == graph::Op::constant)
        factor = std::max(factor, of.number);
  EXPECT_GE(factor, 1 << 14);
  EXPECT_LT(factor, 1 << 16);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, 1e-3);
  const auto field = [](Engine& run) { return std::get<RealFrame>(run.frame(false)).shown[0]; };
  const std::vector<double> first = field(golden);
  golden.advance(300, nullptr), doubles.advance(300, nullptr);
  const std::vector<double> here = field(golden), there = field(doubles);
  double off = 0;
  for (size_t i = 0; i < here.size(); ++i) off = std::max(off, std::abs(here[i] - there[i]));
  EXPECT_GT(off, 0.0625);
  // Neighbours stay apart by half a unit over g dt = 0.03, 1 K; from the middle to an end there are four.
  EXPECT_LT(off, 4);
  EXPECT_EQ(std::accumulate(here.begin(), here.end(), 0.0), std::accumulate(first.begin(), first.end(), 0.0));
}

TEST(IntegerProgram, RefusesResolutionsThatNoFormatHas) {
  const auto refusal = [](const std::string& resolution) {
    return integer_refusal(kHeatText + "resolution." + resolution + "\n");
  };
  EXPECT_NE(refusal("T = \"1e-12 K\"")
                .find("integers of 'T' would have 52 bits, of units of 2^-40 and numbers up "
                      "to 2000 (SI): they have 8 to 46\n  hint: a resolution that is less fine"),
            std::string::npos)
      << refusal("T = \"1e-12 K\"");
  EXPECT_NE(refusal("T = \"100 K\"").find("would have 6 bits, of units of 2^6"), std::string::npos);
  EXPECT_NE(refusal("T = \"3 m\"").find("'T' must be"), std::string::npos) << refusal("T = \"3 m\"");
  EXPECT_NE(refusal("T = \"0 K\"").find("'T' must be"), std::string::npos) << refusal("T = \"0 K\"");
  EXPECT_NE(refusal("U = \"1 K\"").find("the rule has no field 'U'"), std::string::npos);
  EXPECT_NE(integer_refusal(small_block("run = { dt = \"5 ms\", steps = 10 }\n") +
                            "[rule]\nreach = \"1.2 mm\"\nstill = true\n"
                            "particle.on = { kind = \"truth\", resolution = 0.5 }\n"
                            "[[rule.round]]\nfinish.on = \"!on\"\n")
                .find("a truth has no resolution"),
            std::string::npos);
}

TEST(IntegerProgram, ItsFormatsAreProvenAndItsTermIsOdd) {
  const InIntegers made(kHeatText);
  const graph::FixedProgram& program = made.program.program;
  EXPECT_EQ(graph::refusal_of(graph::certificate_of(program)).what, "");
  for (const graph::Round& round : program.rounds) {
    EXPECT_TRUE(graph::exactness_of(round.pair).doubles);
    EXPECT_TRUE(graph::exactness_of(round.finish).doubles);
    const std::vector<graph::Parity> parities = graph::parities_of(round.pair);
    for (const graph::Sum& sum : round.sums)
      for (const int term : sum.terms) EXPECT_TRUE(graph::is_odd(parities[static_cast<size_t>(term)]));
  }
}

// Lennard-Jones as text, cut and shifted in force, with friction by relative velocity.
const std::string kLiquidText =
    "units = \"reduced\"\nmass = 1\n"
    "packing = { pitch = 1.12 }\n"
    "geometry = { shape = \"box\", min = [0, 0, 0], max = [4, 4, 4] }\n"
    "velocity = [ { region = { shape = \"half_space\", point = [0, 2.1, 0], normal = \"y\" }, uniform = "
    "[0.4, "
    "0.3, 0.1] } ]\n"
    "run = { dt = 0.002, steps = 10 }\n"
    "[rule]\nreach = 2.5\n"
    "[rule.let]\npush = \"24 * (2 / r^12 - 1 / r^6) / r^2\"\nedge = \"24 * (2 / reach^12 - 1 / reach^6) / "
    "reach\"\n"
    "[[rule.round]]\n"
    "sum.force = \"-(push - edge / r) * d + 0.3 * (1 - r / reach)^2 * dot(v_j - v_i, d) / r^2 * d\"\n"
    "[rule.energy]\npair = \"4 * (1 / r^12 - 1 / r^6)\"\n";

TEST(IntegerProgram, AForceMovesParticlesAsInDoublesAndKeepsMomentum) {
  const InIntegers made(kLiquidText, 64);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, made.fixed.cell_edge);
  const Momentum before = golden.momentum();
  const auto at = [](Engine& run) { return std::get<RealFrame>(run.frame(false)).x; };
  const std::vector<Vec3> first = at(golden);
  golden.advance(200, nullptr), doubles.advance(200, nullptr);
  EXPECT_EQ(golden.momentum().fixed, before.fixed);
  const std::vector<Vec3> here = at(golden), there = at(doubles);
  double moved = 0, off = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    moved = std::max(moved, (here[i] - first[i]).norm());
    off = std::max(off, (here[i] - there[i]).norm());
  }
  EXPECT_GT(moved, 0.1);
  // Units of a difference are 1.5e-7: forces off by some 1e-5 of a unit of force, over 0.4 of time.
  EXPECT_LT(off, 2e-5);
  Asked asked;
  asked.energies = true;
  EXPECT_NEAR(golden.read(asked).energies.total(), doubles.read(asked).energies.total(), 0.01);
}

// A state in doubles holds all bits of places and fields.
TEST(IntegerProgram, ARunInTwoPartsIsTheRunInOne) {
  std::string text = kLiquidText;
  text.replace(
      text.find("[[rule.round]]\n"), 15,
      "[rule.particle.count]\nrange = [0, 100]\n[[rule.round]]\nfinish.count = \"min(count + 0.3, 90)\"\n");
  const InIntegers made(text, 64);
  IntegerRun whole = made.run(), first = made.run();
  whole.advance(40, nullptr), first.advance(25, nullptr);
  IntegerRun second = made.run_from(*first.saved_body(), 25);
  EXPECT_EQ(second.hash(), first.hash());
  second.advance(15, nullptr);
  EXPECT_EQ(second.hash(), whole.hash());
  EXPECT_NE(first.hash(), whole.hash());
}

TEST(IntegerProgram, PairsNearerThanATableReachesAreAFault) {
  std::string text = kLiquidText;
  text.replace(text.find("uniform = [0.4, 0.3, 0.1]"), 25, "uniform = [0, 40, 0]     ");
  const InIntegers made(text, 128);
  IntegerRun golden = made.run();
  Fault fault = Fault::none;
  try {
    golden.advance(200, nullptr);
  } catch (const RunError& error) {
    fault = error.fault;
  }
  EXPECT_EQ(fault, Fault::strength);
}

TEST(IntegerProgram, WhatIntegersDoNotHoldIsRefused) {
  const std::string run = "run = { dt = \"10 ns\", steps = 10 }\n";
  const std::string own =
      small_block(run) + "[rule]\nreach = \"1.2 * pitch\"\nstill = true\nparticle.a.start = 1\n";
  EXPECT_NE(integer_refusal(own + "[[rule.round]]\nsum.b = \"a_j - a_i\"\nfinish.a = \"a + b\"\n")
                .find("integers need the 'range' of the field 'a'"),
            std::string::npos);
  EXPECT_NE(integer_refusal(
                own + "particle.a.range = [-1, 1]\n[[rule.round]]\nsum.b = \"exp(a_j - a_i)\"\nfinish.a = "
                      "\"a + b\"\n")
                .find("of what may be negative"),
            std::string::npos);
  EXPECT_NE(
      integer_refusal(
          own +
          "particle.a.range = [0, 9]\n[[rule.round]]\nsum.b = \"a_j\"\nfinish.a = \"x.x / (1 mm) + b\"\n")
          .find("knows no position"),
      std::string::npos);
}

}  // namespace
}  // namespace cuboct
