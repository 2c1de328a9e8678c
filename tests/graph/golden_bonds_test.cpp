// SPDX-License-Identifier: MIT
// Golden runs a program whose bonds wear by how far apart their ends are along x, and break for ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "model/contract/golden.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using graph::Builder;
using graph::FixedProgram;
using graph::Parity;
using graph::Source;

constexpr int kBits = 10;  // P; no guard
constexpr int64_t kWorn = 5000;

// wear' = min(wear + |x_j - x_i| / 4 + kind's hardness, kWorn); sum of (wear' way), with the way of the bond.
FixedProgram worn() {
  FixedProgram program;
  program.name = "worn";
  program.bonded = true;
  program.partners = 2;
  program.position_frac = kBits;
  program.velocity = {-512, 511};
  program.fields = {{"pull", 1, {-2 * kWorn, 2 * kWorn}, 0}};
  program.bonds = {{"wear", 1, {0, kWorn}, 0}};
  program.bond_constants = {{"hardness", {3, 7}, 0, Parity::even}, {"way", {-1, 1}, 0, Parity::odd}};
  Builder of_bond;
  program.broken_at = of_bond.eq(read_bond(of_bond, program, 0), of_bond.constant(kWorn));
  program.broken = of_bond.take();

  Builder b, finish;
  b.counts(b.constant(1));
  const int apart = b.round(b.abs(read_apart(b, program, 0)), 2);
  const int more = b.add(b.add(read_bond(b, program, 0), apart), read_bond_constant(b, program, 0));
  const int wear = b.min(more, b.constant(kWorn));
  const int pull = b.mul(wear, read_bond_constant(b, program, 1));
  graph::Round round{.name = "wear", .when = b.when(), .sums = {{"pull", {pull}}}};
  round.bond_writes = {{0, 0, wear}};
  round.pair = b.take();
  round.writes = {{0, 0, read_sum(finish, program, round, 0)}};
  for (int a = 0; a < 3; ++a) program.motion.v.push_back(read_velocity(finish, program, Source::own_v, a));
  program.motion.drift = program.motion.v;
  round.finish = finish.take();
  program.rounds.push_back(std::move(round));
  graph::check(program);
  return program;
}

Lattice row() {
  std::vector<Cell> cells;
  for (int k = 0; k < 8; ++k) cells.push_back({k, 0, 0});
  return Lattice(cells, {});
}

// 0 - 1 - 2, of two kinds and their ways back.
std::shared_ptr<const graph::BondRows> chain() {
  return std::make_shared<graph::BondRows>(
      graph::BondRows{{0, 1, 3, 4}, {1, 0, 2, 1}, {0, 1, 2, 3}, {3, 1, 3, -1, 7, 1, 7, -1}});
}

State three(int64_t speed) {
  State state;
  for (uint32_t id = 0; id < 3; ++id) state.particles.push_back({.id = id, .cell = id, .x = {100, 0, 0}});
  state.particles[2].v[0] = speed;
  return state;
}

TEST(GoldenBonds, WearAsPairsByHandAndAreTheSameAtBothEnds) {
  const Lattice lattice = row();
  Golden golden(worn(), lattice, 4, three(4), chain());
  int64_t left = 0, right = 0;
  for (int64_t step = 0; step < 12; ++step) {
    golden.step();
    left = std::min<int64_t>(left + 1024 / 4 + 3, kWorn);
    right = std::min<int64_t>(right + (1024 + 4 * step) / 4 + 7, kWorn);
    const State now = golden.state();
    ASSERT_EQ(now.bonds, (std::vector<int64_t>{left, left, right, right})) << step;
    ASSERT_EQ(now.bond_begin, (std::vector<uint64_t>{0, 1, 3, 4}));
    ASSERT_EQ(now.fields, (std::vector<int64_t>{left, right - left, -right})) << step;
  }
}

TEST(GoldenBonds, AreOfTheStateAndOfItsHash) {
  const Lattice lattice = row();
  Golden whole(worn(), lattice, 4, three(4), chain());
  for (int k = 0; k < 3; ++k) whole.step();
  Golden rest(worn(), lattice, 4, whole.state(), chain());
  whole.step(), rest.step();
  EXPECT_EQ(whole.state(), rest.state());
  for (size_t b = 0; b < 4; ++b) {
    State other = whole.state();
    ++other.bonds[b];
    EXPECT_NE(hash_of(lattice, other), hash_of(lattice, whole.state())) << b;
  }
}

// A bond of 3 cells ends in no cell around. Speed 500: after 3 steps or so.
TEST(GoldenBonds, ThatCountAndAreNotMetAreAFaultUnlessTheyAreBroken) {
  const Lattice lattice = row();
  const auto told = [&](int64_t wear) {
    State start = three(500);
    start.bonds = {0, 0, wear, wear};
    Golden golden(worn(), lattice, 4, start, chain());
    State before;
    try {
      for (int k = 0; k < 5; ++k) before = golden.state(), golden.step();
    } catch (const RunError& e) {
      EXPECT_EQ(golden.state(), before);  // bonds of others were written
      EXPECT_EQ(e.number, 2);
      EXPECT_EQ(e.particle, 1u);
      EXPECT_EQ(e.cell, 1u);
      return e.fault;
    }
    EXPECT_EQ(golden.state().bonds[2], kWorn);
    return Fault::none;
  };
  EXPECT_EQ(told(0), Fault::bond_lost);
  EXPECT_EQ(told(kWorn), Fault::none);
}

TEST(GoldenBonds, WrittenByOneEndAloneAreRefused) {
  const auto refusal = [](const std::function<void(FixedProgram&)>& change) {
    FixedProgram program = worn();
    change(program);
    return refused_with<std::logic_error>([&] { graph::check(program); });
  };
  const auto hardness = [](FixedProgram& p) -> graph::Node& {
    return *std::ranges::find(p.rounds[0].pair.nodes, Source::bond_constant, &graph::Node::source);
  };
  EXPECT_EQ(refusal([&](auto& p) { hardness(p).symmetric = false; }),
            "the ends of a bond write wear differently");
  EXPECT_EQ(refusal([&](auto& p) { hardness(p).symmetric = false, hardness(p).opposite = true; }),
            "the ends of a bond write wear differently");
  EXPECT_EQ(refusal([](auto& p) { p.bonded = false; }), "a program without bonds writes some");
  EXPECT_EQ(refusal([](auto& p) {
              std::ranges::find(p.broken.nodes, Source::bond_field, &graph::Node::source)->source =
                  Source::own_v;
            }),
            "broken reads own_v");
}

TEST(GoldenBonds, TermsOfAnOddConstantAreOdd) {
  const FixedProgram program = worn();
  const auto parities = graph::parities_of(program.rounds[0].pair);
  EXPECT_EQ(parities[static_cast<size_t>(program.rounds[0].sums[0].terms[0])], Parity::odd);
}

}  // namespace
}  // namespace cuboct
