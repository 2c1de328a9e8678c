// SPDX-License-Identifier: MIT
// Rules of text whose bonds keep fields, in integers: golden beside the same text in doubles.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "model/graph/certificate.h"
#include "model/graph/parity.h"
#include "tests/rules/in_integers.h"

namespace cuboct {
namespace {

// A plate whose left part has a cut half way up, pulled apart at both its edges.
const std::string kPlateText =
    "density = \"2440 kg/m^3\"\n"
    "packing = { pitch = \"1 mm\" }\n"
    "geometry = { shape = \"box\", min = \"[0, -3, 0] mm\", max = \"[8, 3, 1] mm\" }\n"
    "run = { dt = \"0.04 us\", steps = 10 }\n"
    "[regions]\n"
    "top = { shape = \"half_space\", point = \"[0, 2, 0] mm\", normal = \"-y\" }\n"
    "bottom = { shape = \"half_space\", point = \"[0, -2, 0] mm\", normal = \"y\" }\n"
    "[[constraint]]\nname = \"up\"\nkind = \"moved\"\nvelocity = \"[0, 0.5, 0] m/s\"\naxes = \"y\"\nregion = "
    "\"top\"\n"
    "[[constraint]]\nname = \"down\"\nkind = \"moved\"\nvelocity = \"[0, -0.5, 0] m/s\"\naxes = "
    "\"y\"\nregion "
    "= \"bottom\"\n"
    "[rule]\nfile = \"texts/glass.toml\"\n"
    "parameters.youngs_modulus = \"72 GPa\"\nlet.critical_stretch = 0.00091\n"
    "start.whole = \"not ((x_i.y - 0.1 mm) * (x_i.y + d0.y - 0.1 mm) < 0 and x_i.x + d0.x / 2 < 3 mm)\"\n"
    "start.hard = \"abs(x_i.y) > 1.9 mm or abs(x_i.y + d0.y) > 1.9 mm\"\n";

// A free block of springs that yield, whose halves fly apart: it stretches, yields and swings back.
const std::string kSpringsText = small_block(
    "velocity = [ { region = { shape = \"half_space\", point = [\"3 mm\", \"0 mm\", \"0 mm\"], normal = "
    "\"x\" "
    "}, uniform = \"[0.4, 0.1, 0] m/s\" } ]\n"
    "run = { dt = \"0.2 us\", steps = 10 }\n"
    "[rule]\nfile = \"texts/plastic.toml\"\n");

std::vector<Vec3> places(Engine& run) { return std::get<RealFrame>(run.frame(false)).x; }

// The largest difference, and how far particles have moved.
std::pair<double, double> off_and_moved(Engine& here, Engine& there, const std::vector<Vec3>& first) {
  const std::vector<Vec3> x = places(here), y = places(there);
  double off = 0, moved = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    off = std::max(off, (x[i] - y[i]).norm());
    moved = std::max(moved, (x[i] - first[i]).norm());
  }
  return {off, moved};
}

Golden golden_of(const InIntegers& made, const ProgramStart& start) {
  State state = to_fixed(made.scene.body, made.fixed, made.lattice, made.origin);
  const IntegerProgram& program = made.program;
  for (size_t i = 0; i < state.particles.size(); ++i)
    for (size_t f = 0; f < program.field.size(); ++f) {
      const ProgramField& field = made.scene.rule.rounds->text()->particle[program.field[f]];
      for (uint32_t n = 0; n < field.numbers(); ++n)
        state.fields.push_back(
            std::llround(std::ldexp(start.particle[field.first + n][i], program.scales[f].frac)));
    }
  state.bonds = bond_numbers(program, *made.scene.rule.rounds->text(), start);
  return {program.program, made.lattice, made.room, state, program.rows};
}

TEST(IntegerBonds, ACrackIsThatOfDoubles) {
  const InIntegers made(kPlateText);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, made.fixed.cell_edge);
  const std::vector<Vec3> first = places(golden);
  golden.advance(400, nullptr), doubles.advance(400, nullptr);
  const auto [off, moved] = off_and_moved(golden, doubles, first);
  EXPECT_GT(moved, 7e-6);
  // A unit of a difference is 1.7 mm / 2^24 = 1e-10 m, of either sign by chance: a bond's opening is off by
  // 3e-11 m, the dilatation by 1e-8; and waves carry it on for 400 steps.
  EXPECT_LT(off, 3e-9);
  const std::vector<double> here = golden.damage(), there = doubles.damage();
  EXPECT_EQ(std::get<RealFrame>(golden.frame(false)).shown.back(), here);
  EXPECT_EQ(here, there);
  EXPECT_GT(std::accumulate(here.begin(), here.end(), 0.0), 8);
}

TEST(IntegerBonds, BothEndsHoldTheSameAndMomentumIsKept) {
  const InIntegers made(kSpringsText);
  const RuleProgram& text = *made.scene.rule.rounds->text();
  Golden golden = golden_of(made, starts_of(text, made.scene.rule, made.scene.body, made.scene.periodic));
  const Int3 before = momentum(made.fixed, golden.state());
  const graph::BondRows& rows = *made.program.rows;
  size_t yielded = 0;
  for (int k = 0; k < 300; ++k) {
    golden.step();
    ASSERT_EQ(momentum(made.fixed, golden.state()), before) << k;
    if (k % 20 != 0) continue;
    const State now = golden.state();
    yielded = 0;
    for (uint32_t i = 0; i + 1 < rows.first.size(); ++i)
      for (uint64_t b = rows.first[i]; b < rows.first[i + 1]; ++b) {
        ASSERT_EQ(rows.other[rows.twin(i, b)], i);
        ASSERT_EQ(now.bonds[b], now.bonds[rows.twin(i, b)]) << k << ", " << i;
        yielded += now.bonds[b] != 0;
      }
  }
  EXPECT_GT(yielded, 40u);
}

TEST(IntegerBonds, WhatYieldsIsThatOfDoubles) {
  const InIntegers made(kSpringsText);
  IntegerRun golden = made.run();
  RoundsRun doubles(made.scene, made.scene.body, {}, made.fixed.cell_edge);
  const std::vector<Vec3> first = places(golden);
  Asked asked;
  asked.energies = true;
  const double given = doubles.read(asked).energies.total();
  golden.advance(400, nullptr), doubles.advance(400, nullptr);
  const auto [off, moved] = off_and_moved(golden, doubles, first);
  EXPECT_GT(moved, 1e-5);
  EXPECT_LT(off, 2e-9);
  // What yielding took is the area of the loops. Energies are off by as much as openings are: some 1e-8 of r0
  // of 1e-2.
  const double took = given - doubles.read(asked).energies.total();
  EXPECT_GT(took, 0.03 * given);
  EXPECT_NEAR(given - golden.read(asked).energies.total(), took, 1e-5 * took);
}

TEST(IntegerBonds, ARunInTwoPartsIsTheRunInOne) {
  for (const std::string& text : {kSpringsText, kPlateText}) {
    const InIntegers made(text);
    IntegerRun whole = made.run(), first = made.run();
    whole.advance(60, nullptr), first.advance(35, nullptr);
    IntegerRun second = made.run_from(*first.saved_body(), 35);
    second.advance(25, nullptr);
    EXPECT_EQ(second.hash(), whole.hash());
    EXPECT_NE(first.hash(), whole.hash());
    // As a checkpoint holds it.
    State slots{35, {}};
    first.for_each_slot([&](const Particle& particle) { slots.particles.push_back(particle); });
    const std::vector<uint64_t> memory = first.memory().own;
    IntegerRun third(made.scene, {made.program, made.fixed, made.lattice, made.origin, made.room},
                     state_of_checkpoint(slots, made.program, memory));
    EXPECT_EQ(third.hash(), first.hash());
    third.advance(25, nullptr);
    EXPECT_EQ(third.hash(), whole.hash());
    EXPECT_THROW(state_of_checkpoint(slots, made.program, {memory.begin(), memory.end() - 1}), InputError);
  }
}

TEST(IntegerBonds, FormatsAreProvenTablesAreCloseAndForcesAreOdd) {
  for (const std::string& text : {kSpringsText, kPlateText}) {
    const InIntegers made(text);
    const graph::FixedProgram& program = made.program.program;
    EXPECT_EQ(graph::refusal_of(graph::certificate_of(program)).what, "");
    for (const graph::Round& round : program.rounds) {
      EXPECT_TRUE(graph::exactness_of(round.pair).doubles)
          << graph::label(round.pair, graph::exactness_of(round.pair).worst);
      EXPECT_TRUE(graph::exactness_of(round.finish).doubles)
          << graph::label(round.finish, graph::exactness_of(round.finish).worst);
    }
    const graph::Round& last = program.rounds.back();
    const auto parities = graph::parities_of(last.pair);
    for (const graph::Sum& sum : last.sums)
      for (const int term : sum.terms) EXPECT_TRUE(graph::is_odd(parities[static_cast<size_t>(term)]));
    for (const auto& fits : made.program.tables)
      for (const Integers::Fit& fit : fits) EXPECT_LT(fit.error, 1e-6);
  }
  EXPECT_EQ(InIntegers(kPlateText).program.lengths, 2u);
  EXPECT_GE(InIntegers(kPlateText).program.program.broken_at, 0);
  EXPECT_EQ(InIntegers(kSpringsText).program.program.broken_at, -1);
}

Fault fault_after(const std::string& text, int steps) {
  const InIntegers made(text);
  IntegerRun golden = made.run();
  try {
    golden.advance(static_cast<uint64_t>(steps), nullptr);
  } catch (const RunError& error) {
    return error.fault;
  }
  return Fault::none;
}

// At 400 m/s the halves are 16 um further apart after a step of 0.04 us, and beyond 1/8 mm after ten.
TEST(IntegerBonds, BeyondItsTablesABondThatCountsIsAFault) {
  const std::string block = small_block(
      "velocity = [ { region = { shape = \"half_space\", point = [\"3 mm\", \"0 mm\", \"0 mm\"], normal = "
      "\"x\" }, uniform = \"[-400, 0, 0] m/s\" } ]\nrun = { dt = \"0.04 us\", steps = 10 }\n");
  EXPECT_EQ(fault_after(block + "[rule]\nfile = \"texts/plastic.toml\"\n", 40), Fault::strength);
  // Glass breaks at once, and its bonds may be of any length.
  EXPECT_EQ(fault_after(block + "[rule]\nfile = \"texts/glass.toml\"\n", 130), Fault::none);
}

// A bond that no formula calls broken for ever, though it does not count while it is long.
TEST(IntegerBonds, AreLostWhereNothingSaysThatTheyBreak) {
  const std::string text = small_block(
      "velocity = [ { region = { shape = \"half_space\", point = [\"3 mm\", \"0 mm\", \"0 mm\"], normal = "
      "\"x\" }, uniform = \"[-400, 0, 0] m/s\" } ]\nrun = { dt = \"0.04 us\", steps = 10 }\n[rule]\n"
      "bonds = \"reference\"\nreach = \"1.05 * pitch\"\n[[rule.round]]\n"
      "sum.force = { is = \"1 N/m * (r - r0) * d / r\", when = \"r < 1.05 * r0\" }\n");
  EXPECT_EQ(fault_after(text, 90), Fault::bond_lost);
}

TEST(IntegerBonds, WhatIntegersDoNotHoldIsRefused) {
  const std::string own = small_block("run = { dt = \"10 ns\", steps = 10 }\n") +
                          "[rule]\nbonds = \"reference\"\nreach = \"1.2 * pitch\"\nstill = true\n"
                          "particle.a = { start = 1, range = [0, 9] }\n";
  const std::string sums = "sum.b = \"a_j\"\nfinish.a = \"min(a + b, 8)\"\n";
  EXPECT_EQ(integer_refusal(own + "[[rule.round]]\n" + sums), "accepted");
  const auto told = [&](const std::string& text, const std::string& what) {
    const std::string refusal = integer_refusal(own + text + sums);
    EXPECT_NE(refusal.find(what), std::string::npos) << refusal;
  };
  told("bond.w.start = 1\n[[rule.round]]\nbond.w = \"w + 1\"\n",
       "integers need the 'range' of the bonds' field 'w'");
  told("bond.w.range = [0, 2]\n[[rule.round]]\nbond.w = \"min(w + 0.1 * a_i, 1)\"\n",
       "the two ends of a bond may write another 'w'");
  told("bond.w = { range = [-9, 9], start = \"d0.x / (1 mm)\" }\n[[rule.round]]\nbond.w = \"w / 2\"\n",
       "begins as another number at either end");
  told("bond.s.kind = \"truth\"\n[[rule.round]]\nbond.s = \"sin(20 * r / r0) > 0.5\"\n",
       "changes more than once as a bond grows");
  // For 4e-5 mm alone, wherever that is; and what never changes, of which no interval of r says so.
  for (const char* where : {"0.31", "0.99317", "1.01", "1.24"})
    told("bond.s.kind = \"truth\"\n[[rule.round]]\nbond.s = \"abs(r - " + std::string(where) +
             " * r0) < 2e-5 * r0\"\n",
         "changes more than once as a bond grows");
  told("bond.s.kind = \"truth\"\n[[rule.round]]\nbond.s = \"(r - r0) * r - (r - r0) * r < 1e-30 * r0^2\"\n",
       "cannot be shown to change once at most as a bond grows");
}

// A limit is exact: the truth changes from a number of r^2 to the next.
TEST(IntegerBonds, AThresholdOfAnyFormulaIsTaken) {
  const std::string own =
      small_block("run = { dt = \"10 ns\", steps = 10 }\n") +
      "[rule]\nbonds = \"reference\"\nreach = \"1.2 * pitch\"\nstill = true\n"
      "bond.s.kind = \"truth\"\nparticle.a = { range = [0, 20] }\n[[rule.round]]\nsum.b = "
      "{ is = \"1\", when = \"s\" }\nfinish.a = \"b\"\nbond.s = ";
  for (const char* formula : {"log(r / r0) < 0.1", "exp(-r / r0) > 0.33 and r^3 < 2 * r0^3", "r0 / r > 0.9",
                              "min(r, r0) * 2 >= 2 * r0", "sin(r / r0 / 4) < 0.22", "cos(r / r0) > 0.5",
                              "(r / r0)^0.7 < 1.1", "sqrt(r^2 - 0.9 * r0^2) > 0.4 * r0",
                              "select(r < 1.1 * r0, 1, 0) > 0.5", "max(r - r0, 0.5 * r0) < 0.6 * r0"})
    EXPECT_EQ(integer_refusal(own + "\"" + formula + "\"\n"), "accepted") << formula;
}

}  // namespace
}  // namespace cuboct
