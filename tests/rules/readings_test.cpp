// SPDX-License-Identifier: MIT
// What a run of a rule of text in integers tells of a state, and what its terms in doubles are made for.
#include <gtest/gtest.h>

#include <numeric>

#include "model/run/record.h"
#include "tests/rules/in_integers.h"
#include "tests/support/counted_terms.h"

namespace cuboct {
namespace {

std::vector<uint32_t> everyone(const Scene& scene) {
  std::vector<uint32_t> ids(scene.body.size());
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

// Moved at one end, under gravity.
const std::string kPulledCopper =
    "mass = \"63.546 u\"\npacking = { pitch = \"2.556191 angstrom\" }\n"
    "geometry = { shape = \"box\", min = \"[0, 0, 0] angstrom\", max = \"[14, 14, 9] angstrom\" }\n"
    "velocity = [ { temperature = \"900 K\", seed = 3 } ]\n"
    "gravity = \"[0, 0, 1e14] m/s^2\"\n"
    "[[constraint]]\nname = \"grip\"\nkind = \"moved\"\nvelocity = \"[100, 0, 0] m/s\"\n"
    "region = { shape = \"half_space\", point = \"[2, 0, 0] angstrom\", normal = \"-x\" }\n"
    "[run]\ndt = \"2 fs\"\nsteps = 10\n"
    "[rule]\nfile = \"texts/eam.toml\"\npotential.file = \"texts/copper.eam.alloy\"\n";

TEST(ReadingsOfText, VelocitiesAreThoseOfTheDoublesAtThePositionsWithoutTerms) {
  InIntegers made(kPulledCopper, 64);
  const auto terms = test::count_terms(made.scene);
  IntegerRun golden = made.run();
  const std::vector<uint32_t> ids = everyone(made.scene);
  const Asked asked{.ids = ids, .velocities = true};
  size_t imposed = 0;
  for (int k = 0; k < 4; ++k) {
    const Reading reading = golden.read(asked);
    ASSERT_EQ(terms->made(), 0);
    ASSERT_EQ(reading.v.size(), ids.size());
    // The same state in doubles.
    const Body body = to_real(std::get<State>(golden.integers()), made.fixed, made.lattice, made.origin);
    const Scene plain = parse_scene(kPulledCopper, kIntegerTexts + "test.toml");
    RoundsRun doubles(plain, body, {}, made.fixed.cell_edge);
    const Reading there = doubles.read(asked);
    double gain = 0;
    for (size_t i = 0; i < ids.size(); ++i) {
      gain = std::max(gain, (there.v[i] - body.v[i]).norm());
      imposed += plain.rule.types[body.type[i]].imposed[0];
    }
    // A table of integers is off by some 2e-4 of its forces.
    EXPECT_GT(gain, 10);
    for (size_t i = 0; i < ids.size(); ++i) EXPECT_LT((reading.v[i] - there.v[i]).norm(), 1e-3 * gain) << i;
    for (size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(reading.x[i], there.x[i]) << i;
    golden.advance(7, nullptr);
  }
  EXPECT_GT(imposed, 0u);
}

TEST(ReadingsOfText, ALookLeavesNoTrace) {
  const InIntegers made(kPulledCopper, 64);
  IntegerRun looked = made.run(), alone = made.run();
  const std::vector<uint32_t> ids = everyone(made.scene);
  for (int k = 0; k < 5; ++k) {
    looked.read({.ids = ids, .forces = true, .velocities = true, .energies = true});
    looked.advance(2, nullptr), alone.advance(2, nullptr);
    EXPECT_EQ(looked.hash(), alone.hash());
  }
}

TEST(ReadingsOfText, ForcesAndEnergiesAreTheTerms) {
  for (const bool energies : {false, true}) {
    InIntegers made(kPulledCopper, 64);
    const auto terms = test::count_terms(made.scene);
    IntegerRun golden = made.run();
    golden.advance(3, nullptr);
    EXPECT_EQ(terms->made(), 0);
    const std::vector<uint32_t> ids{0, 5};
    const Reading reading = golden.read({.ids = ids, .forces = !energies, .energies = energies});
    EXPECT_EQ(terms->made(), 1);
    const Body body = to_real(std::get<State>(golden.integers()), made.fixed, made.lattice, made.origin);
    const Scene plain = parse_scene(kPulledCopper, kIntegerTexts + "test.toml");
    RoundsRun doubles(plain, body, {}, made.fixed.cell_edge);
    const Reading there = doubles.read({.ids = ids, .forces = true, .energies = true});
    if (energies) {
      EXPECT_EQ(reading.energies.potential, there.energies.potential);
      EXPECT_NEAR(reading.energies.kinetic, there.energies.kinetic, 1e-3 * there.energies.kinetic);
    } else {
      EXPECT_EQ(reading.force, there.force);
    }
  }
}

// The kept field of heat, in the integers of the state.
TEST(ReadingsOfText, AFieldThatGoesOnNeedsNoTerms) {
  const std::string text = small_block("run = { dt = \"5 ms\", steps = 10 }\n") +
                           "[rule]\nfile = \"texts/heat.toml\"\n"
                           "start.T = \"300 K + 20 K/mm * x.x + 3 K/mm * x.y\"\n";
  InIntegers made(text);
  const auto terms = test::count_terms(made.scene);
  IntegerRun golden = made.run();
  golden.advance(40, nullptr);
  const std::vector<uint32_t> ids{1, 7, 20};
  const Reading reading = golden.read({.ids = ids, .fields = true});
  const RealFrame frame = std::get<RealFrame>(golden.frame(false));
  EXPECT_EQ(terms->made(), 0);
  RoundsRun doubles(made.scene, made.scene.body, {}, 1e-3);
  doubles.advance(40, nullptr);
  const Reading there = doubles.read({.ids = ids, .fields = true});
  ASSERT_EQ(reading.fields.size(), 1u);
  ASSERT_EQ(reading.fields[0].size(), 3u);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(reading.fields[0][k], there.fields[0][k], 1e-4);
    EXPECT_EQ(reading.fields[0][k], frame.shown[0][ids[k]]);
  }
  EXPECT_NE(reading.fields[0][0], reading.fields[0][2]);
}

// The largest of all states that were looked at, not of the start alone.
TEST(ReadingsOfText, TheLargestSpeedIsThatOfTheStates) {
  const std::string text =
      "units = \"reduced\"\nmass = 1\npacking = { pitch = 1 }\n"
      "geometry = { shape = \"box\", min = [0, 0, 0], max = [2, 2, 2] }\nrun = { dt = 0.01, steps = 10 }\n"
      "[rule]\nreach = 1.2\n[[rule.round]]\nsum.force = \"(r - 1.05) * d / r\"\n";
  const InIntegers made(text);
  IntegerRun golden = made.run();
  EXPECT_EQ(golden.largest_speed(), 0);
  golden.advance(20, nullptr);
  double most = 0;
  const auto state = golden.integers();
  for (const Particle& p : std::get<State>(state).particles)
    for (const int64_t v : p.v) most = std::max(most, std::ldexp(std::abs(static_cast<double>(v)), -38));
  EXPECT_GT(most, 0);
  EXPECT_NEAR(golden.largest_speed(), most, 1e-12);
}

// A step that cannot be done has no velocities: the terms tell what it would add.
TEST(ReadingsOfText, BeforeAFaultTheTermsTellVelocities) {
  const std::string text =
      "units = \"reduced\"\nmass = 1\npacking = { pitch = 1.12 }\n"
      "geometry = { shape = \"box\", min = [0, 0, 0], max = [3, 3, 3] }\n"
      "velocity = [ { region = { shape = \"half_space\", point = [0, 1.6, 0], normal = \"y\" }, uniform = "
      "[0, "
      "200, 0] } ]\n"
      "run = { dt = 0.0005, steps = 10 }\n"
      "[rule]\nreach = 2.5\n[[rule.round]]\nsum.force = \"-24 * (2 / r^14 - 1 / r^8) * d\"\n";
  InIntegers made(text, 64);
  const auto terms = test::count_terms(made.scene);
  IntegerRun golden = made.run();
  std::string told;
  try {
    golden.advance(400, nullptr);
  } catch (const RunError& error) {
    told = error.what();
  }
  ASSERT_NE(told.find("out of width"), std::string::npos) << told;
  EXPECT_EQ(terms->made(), 0);
  const std::vector<uint32_t> ids = everyone(made.scene);
  const Reading reading = golden.read({.ids = ids, .velocities = true});
  EXPECT_EQ(terms->made(), 1);
  for (const Vec3& v : reading.v) EXPECT_TRUE(v.allFinite());
}

}  // namespace
}  // namespace cuboct
