// SPDX-License-Identifier: MIT
// Golden runs a program of two rounds with fields: heat between neighbours, weighted by how many each has.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "model/base/fixed_math.h"
#include "model/contract/golden.h"
#include "tests/support/dice.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

using graph::Builder;
using graph::FixedProgram;
using graph::Source;
using test::Dice;

constexpr int kPosition = 10, kGuard = 2, kRingCapacity = 4;
constexpr int64_t kReach2 = 700 * 700;

int distance2(Builder& b, const FixedProgram& program) {
  std::vector<int> d;
  for (int a = 0; a < 3; ++a) d.push_back(read_apart(b, program, a));
  return b.dot(d, d);
}

graph::Round counted(const FixedProgram& program) {
  Builder pair, finish;
  pair.counts(pair.lt(distance2(pair, program), pair.constant(kReach2)));
  graph::Round round{.name = "count", .when = pair.when(), .sums = {{"neighbours", {pair.constant(1)}}}};
  round.pair = pair.take();
  round.writes = {{0, 0, read_sum(finish, program, round, 0)}};
  round.finish = finish.take();
  return round;
}

graph::Round heated(FixedProgram& program, int shift) {
  Builder b, finish;
  b.counts(b.lt(distance2(b, program), b.constant(kReach2)));
  const auto own = [&](int field) { return read_field(b, program, Source::own_field, field); };
  const auto other = [&](int field) { return read_field(b, program, Source::other_field, field); };
  const int gain = b.mul(b.sub(other(1), own(1)), b.add(own(0), other(0)), shift);
  graph::Round round{.name = "heat", .when = b.when(), .sums = {{"gain", {gain}}}};
  round.pair = b.take();
  const int T = read_field(finish, program, Source::own_field, 1);
  const int next = finish.add(T, read_sum(finish, program, round, 0));
  round.writes = {{1, 0, finish.check(next, 24, Fault::sum)}};
  for (int a = 0; a < 3; ++a) program.motion.v.push_back(read_velocity(finish, program, Source::own_v, a));
  program.motion.drift = program.motion.v;
  round.finish = finish.take();
  return round;
}

FixedProgram heat(int shift = 9) {
  FixedProgram program;
  program.name = "heat";
  program.partners = 27 * kRingCapacity - 1;
  program.position_frac = kPosition, program.guard = kGuard;
  program.velocity = {-1024, 1023};
  program.fields = {{"n", 1, {0, program.partners}, 0}, {"T", 1, {-(1 << 23), (1 << 23) - 1}, 8}};
  program.rounds.push_back(counted(program));
  program.rounds.push_back(heated(program, shift));
  graph::check(program);
  return program;
}

Lattice ring() {
  std::vector<Cell> cells;
  for (int k = 0; k < 27; ++k) cells.push_back({k % 3, k / 3 % 3, k / 9});
  return Lattice(cells, {3, 3, 3});
}

State warm(uint64_t seed) {
  Dice dice(seed);
  State state;
  for (uint32_t id = 0; id < 40; ++id) {
    Particle p{.id = id, .cell = id % 27};
    for (size_t a = 0; a < 3; ++a) {
      p.x[a] = static_cast<int64_t>(dice.bits(kPosition + kGuard));
      p.v[a] = dice.draw(-40, 40);
    }
    state.particles.push_back(p);
    state.fields.insert(state.fields.end(), {0, dice.draw(-100000, 100000)});
  }
  return state;
}

// Neighbours and temperatures after a step, pair by pair over the whole ring.
std::vector<int64_t> by_hand(const Lattice& lattice, const State& state) {
  const size_t n = state.particles.size();
  const auto near = [&](const Particle& i, const Particle& j) {
    int64_t r2 = 0;
    for (size_t a = 0; a < 3; ++a) {
      int cells = lattice.cell(j.cell)[a] - lattice.cell(i.cell)[a];
      cells = (cells + 4) % 3 - 1;
      const int64_t d = (j.x[a] >> kGuard) - (i.x[a] >> kGuard) + (int64_t{cells} << kPosition);
      r2 += d * d;
    }
    return i.id != j.id && r2 < kReach2;
  };
  std::vector<int64_t> fields = state.fields;
  for (size_t i = 0; i < n; ++i) {
    fields[2 * i] = 0;
    for (size_t j = 0; j < n; ++j) fields[2 * i] += near(state.particles[i], state.particles[j]);
  }
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j)
      if (near(state.particles[i], state.particles[j]))
        fields[2 * i + 1] += round_odd(
            (state.fields[2 * j + 1] - state.fields[2 * i + 1]) * (fields[2 * i] + fields[2 * j]), 9);
  return fields;
}

int64_t total(const State& state) {
  int64_t sum = 0;
  for (size_t k = 1; k < state.fields.size(); k += 2) sum += state.fields[k];
  return sum;
}

TEST(GoldenProgram, OfTwoRoundsIsWhatPairsByHandMake) {
  const Lattice lattice = ring();
  const State start = warm(1);
  Golden golden(heat(), lattice, kRingCapacity, start);
  std::vector<uint32_t> cells;
  for (int step = 0; step < 30; ++step) {
    const State before = golden.state();
    golden.step();
    ASSERT_EQ(golden.state().fields, by_hand(lattice, before)) << "step " << step;
    ASSERT_EQ(total(golden.state()), total(start)) << "step " << step;
  }
  size_t moved = 0;
  for (const Particle& p : golden.state().particles) moved += p.cell != start.particles[p.id].cell;
  EXPECT_GT(moved, 5u);
}

TEST(GoldenProgram, GoesOnFromItsFields) {
  const Lattice lattice = ring();
  Golden whole(heat(), lattice, kRingCapacity, warm(2));
  for (int step = 0; step < 4; ++step) whole.step();
  Golden rest(heat(), lattice, kRingCapacity, whole.state());
  whole.step(), rest.step();
  EXPECT_EQ(whole.state(), rest.state());
  State other = whole.state();
  ++other.fields[7];
  EXPECT_NE(hash_of(lattice, other), hash_of(lattice, whole.state()));
  other.fields.clear();
  uint64_t particles = 0;
  for (const Particle& p : other.particles) particles += hash_of(lattice, p);
  EXPECT_EQ(hash_of(lattice, other), particles);
}

TEST(GoldenProgram, ReportsTheFaultOfAFinish) {
  const Lattice lattice = ring();
  State start = warm(3);
  for (size_t k = 1; k < start.fields.size(); k += 2)
    start.fields[k] = (k % 4 == 1 ? 1 : -1) * ((1 << 23) - 1);
  Golden golden(heat(1), lattice, kRingCapacity, start);
  const State before = golden.state();
  try {
    golden.step();
    FAIL();
  } catch (const RunError& e) {
    EXPECT_EQ(golden.state(), before);  // the first round wrote how many neighbours there are
    EXPECT_EQ(e.fault, Fault::sum);
    EXPECT_FALSE(fits(e.number, 24));
  }
}

TEST(Program, ThatDoesNotHoldTogetherIsRefused) {
  const auto refusal = [](const std::function<void(FixedProgram&)>& change) {
    FixedProgram program = heat();
    change(program);
    return refused_with<std::logic_error>([&] { graph::check(program); });
  };
  EXPECT_EQ(refusal([](auto& p) { p.fields[0].range.high = 9; }), "field n lies in [0, 107], beyond [0, 9]");
  EXPECT_EQ(refusal([](auto& p) { p.rounds[0].when = 1000; }), "when: no such node");
  EXPECT_EQ(refusal([](auto& p) { p.velocity.high = 7; }),
            "the velocity lies in [-1024, 1023], beyond [-1024, 7]");
  EXPECT_EQ(refusal([](auto& p) { p.motion.v.pop_back(); }), "the motion has one node for each axis");
  EXPECT_EQ(refusal([](auto& p) {
              p.bonded = true;
              p.bonds = {{"whole", 1, {-4096, 4096}, 0}};
              const auto& nodes = p.rounds[0].pair.nodes;
              const auto is_input = [](const graph::Node& node) { return node.op == graph::Op::input; };
              const auto apart = std::find_if(nodes.begin(), nodes.end(), is_input);
              p.rounds[0].bond_writes = {{0, 0, static_cast<int>(apart - nodes.begin())}};
            }),
            "the ends of a bond write whole differently");
}

}  // namespace
}  // namespace cuboct
