// SPDX-License-Identifier: MIT
// Embedded atoms in integers, beside doubles.
#include <gtest/gtest.h>

#include "model/base/error.h"
#include "model/graph/certificate.h"
#include "model/graph/parity.h"
#include "tests/rules/in_integers.h"
#include "tests/rules/metal.h"

namespace cuboct {
namespace {

// A free block of copper, 300 K and more, whose corners evaporate nothing in 2 ps.
const std::string kHotBlock =
    "mass = \"63.546 u\"\npacking = { pitch = \"2.556191 angstrom\" }\n"
    "geometry = { shape = \"box\", min = \"[0, 0, 0] angstrom\", max = \"[14, 14, 9] angstrom\" }\n"
    "velocity = [ { temperature = \"900 K\", seed = 3 } ]\n"
    "run = { dt = \"2 fs\", steps = 10 }\n"
    "rule = { file = \"texts/eam.toml\", potential.file = \"texts/copper.eam.alloy\" }\n";

std::vector<Vec3> atom_places(Engine& run) { return std::get<RealFrame>(run.frame(false)).x; }

TEST(EmbeddedAtomsInIntegers, MoveAsInDoublesAndKeepMomentumAndEnergy) {
  const InIntegers made(kHotBlock, 64);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, made.fixed.cell_edge);
  const Momentum before = golden.momentum();
  const std::vector<Vec3> first = atom_places(golden);
  Asked asked;
  asked.energies = true;
  const auto energy = [&](Engine& run) { return run.read(asked).energies.total() / test::kEv; };
  golden.advance(50, nullptr), doubles.advance(50, nullptr);
  const std::vector<Vec3> here = atom_places(golden), there = atom_places(doubles);
  double moved = 0, off = 0;
  for (size_t i = 0; i < here.size(); ++i) {
    moved = std::max(moved, (here[i] - first[i]).norm() / test::kAngstrom);
    off = std::max(off, (here[i] - there[i]).norm() / test::kAngstrom);
  }
  EXPECT_GT(moved, 0.2);
  // The pair's third derivative has steps of some 20 eV/angstrom^3: a parabola over 0.015 angstrom is off by
  // 2e-4 eV/angstrom there. Within 0.1 ps such a force moves an atom by 1.5e-4 angstrom.
  EXPECT_LT(off, 2e-4);
  double low = INFINITY, high = -low;
  for (int k = 0; k < 20; ++k) {
    golden.advance(10, nullptr);
    const double now = energy(golden);
    low = std::min(low, now), high = std::max(high, now);
  }
  EXPECT_EQ(golden.momentum().fixed, before.fixed);
  // The kinetic energy is that of half a step before: it breathes by 2e-4 of what it exchanges.
  EXPECT_LT((high - low) / static_cast<double>(here.size()), 2e-3);
}

TEST(EmbeddedAtomsInIntegers, FormatsAreProvenAndTheForceIsOdd) {
  const InIntegers made(kHotBlock, 64);
  const graph::FixedProgram& program = made.program.program;
  EXPECT_EQ(graph::refusal_of(graph::certificate_of(program)).what, "");
  const graph::Round& pull = program.rounds.back();
  const std::vector<graph::Parity> parities = graph::parities_of(pull.pair);
  for (const graph::Sum& sum : pull.sums)
    for (const int term : sum.terms) EXPECT_TRUE(graph::is_odd(parities[static_cast<size_t>(term)]));
  for (const graph::Round& round : program.rounds) {
    EXPECT_TRUE(graph::exactness_of(round.pair).doubles);
    EXPECT_TRUE(graph::exactness_of(round.finish).doubles);
  }
}

// Nearest neighbours at 1.85 angstrom, with a density of some 80, that run into others. The table ends at
// 100.
TEST(EmbeddedAtomsInIntegers, ADensityBeyondTheTableIsAFault) {
  std::string text = kHotBlock;
  text.replace(text.find("2.556191"), 8, "1.850000");
  text.replace(text.find("[14, 14, 9]"), 11, "[8, 8, 8]  ");
  text.replace(text.find("dt = \"2 fs\""), 11, "dt = \"0.2 fs\"");
  text.replace(
      text.find("{ temperature = \"900 K\", seed = 3 }"), 35,
      "{ region = { shape = \"half_space\", point = \"[0, 4.1, 0] angstrom\", normal = \"y\" }, uniform = "
      "\"[0, 20, 0] km/s\" }");
  const InIntegers made(text, 200);
  try {
    IntegerRun golden = made.run();
    golden.advance(200, nullptr);
    ADD_FAILURE() << "no fault";
  } catch (const RunError& error) {
    EXPECT_EQ(error.fault, Fault::sum);
  }
}

}  // namespace
}  // namespace cuboct
