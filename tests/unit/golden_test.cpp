// SPDX-License-Identifier: MIT
#include "model/contract/golden.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "model/base/fixed_math.h"
#include "model/real/reference.h"
#include "tests/support/block.h"

namespace cuboct {
namespace {

using test::block;
using test::Features;

State run(const Setup& setup, const State& from, int steps) {
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, from);
  for (int k = 0; k < steps; ++k) golden.step();
  return golden.state();
}

// P = 20, G = 8, D = 16, whatever the scene would have.
Arch plain() {
  Arch arch;
  arch.widths = {};
  return arch;
}

Features hot() { return {.size = {3, 2, 2}, .speed = 0.12, .margin = 4}; }

// How often a particle changed cell between two states of the same particles.
int moves(const State& a, const State& b) {
  int count = 0;
  for (size_t k = 0; k < a.particles.size(); ++k) count += a.particles[k].cell != b.particles[k].cell;
  return count;
}

// Exact, in P+G fractional bits from the corner of cell (0, 0, 0).
Int3 place(const Plan& plan, const Particle& p) {
  Int3 x = p.x;
  for (int a = 0; a < 3; ++a)
    x[a] += int64_t{plan.lattice.cell(p.cell)[a]} << plan.rule.widths.velocity_frac();
  return x;
}

void put(const Plan& plan, const Int3& place, Particle& p) {
  const int frac = plan.rule.widths.velocity_frac();
  Cell cell;
  for (int a = 0; a < 3; ++a) {
    cell[a] = static_cast<int32_t>(place[a] >> frac);
    p.x[a] = place[a] & ((int64_t{1} << frac) - 1);
  }
  p.cell = plan.lattice.find(cell);
  ASSERT_NE(p.cell, kNoCell);
}

Int3 sum_of_places(const Plan& plan, const State& state) {
  Int3 sum{};
  for (const Particle& p : state.particles)
    for (int a = 0; a < 3; ++a) sum[a] += place(plan, p)[a];
  return sum;
}

// Particles whose bits below a visible unit differ.
int other_residues(const Plan& plan, const State& a, const State& b) {
  const int64_t mask = (int64_t{1} << plan.rule.widths.guard) - 1;
  int count = 0;
  for (size_t k = 0; k < a.particles.size(); ++k)
    count += (a.particles[k].x[0] & mask) != (b.particles[k].x[0] & mask);
  return count;
}

TEST(RoundOdd, HalvesGoAwayFromZeroAndItIsOdd) {
  EXPECT_EQ(round_odd(3, 1), 2);  // 1.5
  EXPECT_EQ(round_odd(-3, 1), -2);
  EXPECT_EQ(round_odd(5, 2), 1);  // 1.25
  EXPECT_EQ(round_odd(6, 2), 2);  // 1.5
  EXPECT_EQ(round_odd(-6, 2), -2);
  EXPECT_EQ(round_odd(7, 0), 7);
  for (int64_t a = -4096; a <= 4096; ++a)
    for (int s = 0; s < 14; ++s) ASSERT_EQ(round_odd(-a, s), -round_odd(a, s)) << a << " " << s;
}

// Two particles at rest, half a spacing of bond away from equilibrium along x: the kick is f(r)/m dt, by
// hand.
TEST(Golden, OneStepOfTwoParticlesByHand) {
  Scene scene = test::block_scene({.jitter = 0, .speed = 0});
  scene.body.x = {Vec3(0, 0, 0), Vec3(1.1, 0, 0)};
  scene.body.v.assign(2, Vec3::Zero());
  scene.body.type.assign(2, 0);
  const auto setup = make_setup(scene, {});
  const State after = run(setup, setup.initial, 1);
  const Body body = to_real(after, setup.plan.rule, setup.plan.lattice, setup.plan.origin);
  const double f = scene.rule.law->force(1.1), v = f * scene.rule.dt;  // m = 1; f < 0 attracts
  ASSERT_LT(f, -0.01);
  // The table's error, as the quantiser reports it, plus half a unit of d (2^-17 cells on a slope near 1).
  const double bound = (setup.plan.rule.error().worst_force + 1.6 / (1 << 17)) * scene.rule.dt;
  EXPECT_NEAR(body.v[0].x(), -v, bound);
  EXPECT_NEAR(body.v[1].x(), v, bound);
  // Half a unit of the position at the start and half a unit of v.
  EXPECT_NEAR(body.x[1].x(), 1.1 + v * scene.rule.dt, bound * scene.rule.dt + 1.6 / (1 << 28));
  EXPECT_EQ(after.particles[0].v[0], -after.particles[1].v[0]);
  EXPECT_EQ(after.particles[0].v[1], 0);
}

TEST(Golden, MomentumOfAFreeBodyStaysToTheLastBit) {
  for (const double damping : {0.0, 0.1}) {
    const auto setup =
        block({.size = {2, 2, 2}, .speed = 0.03, .damping = damping, .two_materials = true, .margin = 6});
    constexpr int kSteps = 4000;
    const State after = run(setup, setup.initial, kSteps);
    EXPECT_EQ(momentum(setup.plan.rule, after), momentum(setup.plan.rule, setup.initial));
    // And as no drift is rounded, it carries the centre of mass along to the last bit.
    Int3 expected = sum_of_places(setup.plan, setup.initial);
    for (int a = 0; a < 3; ++a) expected[a] += kSteps * momentum(setup.plan.rule, after)[a];
    EXPECT_EQ(sum_of_places(setup.plan, after), expected);
    EXPECT_GT(moves(setup.initial, after), 3);
  }
}

TEST(Golden, UndampedRunReversesBitForBit) {
  const auto setup = block(hot());
  const int steps = 2000;
  const State first = run(setup, setup.initial, 1), last = run(setup, setup.initial, steps);
  const State beyond = run(setup, last, 1);
  ASSERT_GT(moves(setup.initial, last), 10);
  ASSERT_GT(other_residues(setup.plan, setup.initial, last), 40);  // of 48
  State back = last;  // positions of `steps`, velocities half a step later and negated
  for (size_t k = 0; k < back.particles.size(); ++k)
    for (int a = 0; a < 3; ++a) back.particles[k].v[a] = -beyond.particles[k].v[a];
  back = run(setup, back, steps);
  for (size_t k = 0; k < back.particles.size(); ++k) {
    ASSERT_EQ(back.particles[k].cell, setup.initial.particles[k].cell) << k;
    ASSERT_EQ(back.particles[k].x, setup.initial.particles[k].x) << k;
    for (int a = 0; a < 3; ++a) ASSERT_EQ(back.particles[k].v[a], -first.particles[k].v[a]) << k;
  }
}

TEST(Golden, OrderOfParticlesChangesNoBit) {
  const auto setup = block(hot());
  State shuffled = setup.initial;
  std::shuffle(shuffled.particles.begin(), shuffled.particles.end(), std::mt19937_64(7));
  ASSERT_NE(shuffled.particles, setup.initial.particles);
  EXPECT_EQ(run(setup, shuffled, 300), run(setup, setup.initial, 300));
}

TEST(Golden, TranslationByWholeCellsChangesNoBit) {
  const auto setup = block(hot());
  const Cell by{5, -3, 2};
  std::vector<Cell> cells;
  for (uint32_t n = 0; n < setup.plan.lattice.size(); ++n) {
    Cell c = setup.plan.lattice.cell(n);
    for (int a = 0; a < 3; ++a) c[a] += by[a];
    cells.push_back(c);
  }
  const Lattice moved(cells, {0, 0, 0});
  ASSERT_EQ(moved.size(), setup.plan.lattice.size());
  State state = setup.initial;  // cell indices follow (z, y, x), so they stay what they were
  Golden golden(setup.plan.rule, moved, setup.plan.arch.capacity, state);
  for (int k = 0; k < 300; ++k) golden.step();
  EXPECT_EQ(golden.state(), run(setup, setup.initial, 300));
  EXPECT_NE(hash_of(moved, golden.state()),
            hash_of(setup.plan.lattice, golden.state()));  // cells are part of the hash
}

// Differences of positions are those of what is visible, and a step of the visible unit leaves them as they
// are.
TEST(Golden, TranslationByVisibleUnitsChangesNoMotion) {
  const auto setup = block(hot());
  const Plan& plan = setup.plan;
  const State after = run(setup, setup.initial, 300);
  const int G = plan.rule.widths.guard;
  for (const Int3& units : {Int3{1, 0, 0}, Int3{1, -3, 8}, Int3{-12345, 6, 700001}}) {
    const Int3 by{units[0] << G, units[1] << G, units[2] << G};
    const auto moved = [&](State state) {
      for (Particle& p : state.particles) {
        Int3 x = place(plan, p);
        for (int a = 0; a < 3; ++a) x[a] += by[a];
        put(plan, x, p);
      }
      return state;
    };
    EXPECT_EQ(run(setup, moved(setup.initial), 300), moved(after)) << units[0];
  }
  EXPECT_GT(moves(setup.initial, after), 10);
}

// 3, -5 and 1 of the 2^G = 256 parts of a visible unit per step: over the upper face in x, the lower one in
// y, and back.
TEST(Golden, SlowParticlesMoveByTheirVelocityExactly) {
  const Int3 slow{3, -5, 1};
  const int64_t steps = 1000;
  for (const bool imposed : {false, true}) {
    Scene scene = test::block_scene({.size = {1, 1, 1}, .jitter = 0, .speed = 0, .margin = 3});
    scene.body.x = {Vec3(0, 0, 0)};
    scene.body.v = {Vec3::Zero()};
    scene.body.type = {0};
    auto setup = make_setup(scene, plain());
    ASSERT_EQ(setup.plan.rule.widths.guard, 8);
    const auto drive = [&](Particle& p, const Int3& v) {
      p.v = v;
      if (imposed)
        setup.plan.rule.types[0].imposed = {true, true, true}, setup.plan.rule.types[0].velocity = v;
    };
    State state = setup.initial;
    state.particles[0].x = {(int64_t{1} << setup.plan.rule.widths.velocity_frac()) - 40, 17, 5000};
    const Particle start = state.particles[0];
    drive(state.particles[0], slow);
    state = run(setup, state, steps);
    const Particle there = state.particles[0];
    for (int a = 0; a < 3; ++a)
      EXPECT_EQ(place(setup.plan, there)[a] - place(setup.plan, start)[a], steps * slow[a]) << a;
    const Cell &from = setup.plan.lattice.cell(start.cell), &to = setup.plan.lattice.cell(there.cell);
    EXPECT_EQ(to, (Cell{from[0] + 1, from[1] - 1, from[2]}));
    drive(state.particles[0], {-slow[0], -slow[1], -slow[2]});
    state = run(setup, state, steps);
    EXPECT_EQ(state.particles[0].x, start.x);
    EXPECT_EQ(state.particles[0].cell, start.cell);
  }
}

// How far, in units of position, the middle of a chain of 13 gets where one end is held and the other moved
// by `units` per step: in fixed numbers, in doubles. Means over the steps 10,000 to 20,000, as the chain
// rings from the start on, with a phase that the formats' stiffness decides.
std::pair<double, double> middle_of_a_chain(double units) {
  Scene scene = test::block_scene({.size = {1, 1, 1}, .jitter = 0, .speed = 0, .margin = 1});
  scene.body = {};
  for (int k = 0; k < 13; ++k) scene.body.x.push_back(Vec3(k, 0, 0));
  scene.body.v.assign(13, Vec3::Zero());
  scene.body.type.assign(13, 0);
  scene.body.type.front() = 1, scene.body.type.back() = 2;
  scene.rule.types.resize(3, scene.rule.types[0]);
  scene.rule.types[1].imposed = scene.rule.types[2].imposed = {true, true, true};
  const double unit = make_setup(scene, plain()).plan.rule.cell_edge * 0x1p-20;
  // A whole number of 2^-G units: the formats hold it exactly.
  scene.rule.types[2].velocity.x() = std::round(units * 256) / 256 * unit / scene.rule.dt;
  const auto setup = make_setup(scene, plain());
  const Plan& plan = setup.plan;
  const int64_t from = place(plan, setup.initial.particles[6])[0];
  Reference reference(scene.rule, scene.body, {}, Integrator::semi_implicit_euler);
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, setup.initial);
  double got = 0, expected = 0;
  int samples = 0;
  for (int step = 1; step <= 20000; ++step) {
    reference.step();
    golden.step();
    if (step < 10000 || step % 10 != 0) continue;
    got += static_cast<double>(place(plan, golden.state().particles[6])[0] - from) / 256;
    expected += (reference.body().x[6].x() - 6) / unit;
    ++samples;
  }
  return {got / samples, expected / samples};
}

// Not a unit of position is lost on the way, 1/16 of the unit of a difference.
TEST(Golden, SlowMotionGoesThroughAChain) {
  for (const double units : {0.33, 0.7, 1.3, 5.2}) {
    const auto [got, expected] = middle_of_a_chain(units);
    std::printf("%.2f units per step: %.2f of %.2f units, %.5f\n", units, got, expected, got / expected);
    EXPECT_GT(expected, 2000);
    EXPECT_NEAR(got, expected, 1) << units;
  }
}

TEST(Golden, HeldParticlesStandAndMovedOnesMove) {
  const auto setup = block({.damping = 0.1, .held = true, .gravity = true});
  const State after = run(setup, setup.initial, 50);
  int held = 0, moved = 0;
  for (size_t k = 0; k < after.particles.size(); ++k) {
    const Particle& a = setup.initial.particles[k];
    const Particle& b = after.particles[k];
    const FixedType& type = setup.plan.rule.types[b.type];
    if (!type.imposed[0]) continue;
    EXPECT_EQ(b.v, type.velocity);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(place(setup.plan, b)[axis] - place(setup.plan, a)[axis], 50 * type.velocity[axis]);
    (type.velocity == Int3{} ? held : moved)++;
  }
  EXPECT_EQ(held, 18);
  EXPECT_EQ(moved, 18);
}

// A PD-held layer comes to rest where kp u balances the load; kp and the weight of the column are known.
TEST(Golden, ForceHeldTypeCarriesTheWeight) {
  Scene scene = test::block_scene(
      {.size = {1, 1, 1}, .jitter = 0, .speed = 0, .damping = 0.2, .force_held = true, .gravity = true});
  scene.body.x = {Vec3(0, 0, 0)};
  scene.body.v = {Vec3::Zero()};
  scene.body.type = {0};
  ASSERT_TRUE(scene.rule.types[0].pd);
  const auto setup = make_setup(scene, {});
  const State after = run(setup, setup.initial, 2000);
  const double unit = std::ldexp(setup.plan.rule.cell_edge, -setup.plan.rule.widths.velocity_frac());
  const double expected = -1e-3 / 1.5;  // m g / kp
  // At rest kp u dt^2/m rounds to g dt^2 within half a unit, so u to half a unit over kp dt^2; gains and g to
  // 1e-3.
  EXPECT_NEAR(static_cast<double>(after.particles[0].u[2]) * unit, expected, 2e-3 * -expected);
  EXPECT_EQ(after.particles[0].u[0], 0);
  // The anchor stands, so that x and u went the same way.
  const Int3 from = place(setup.plan, setup.initial.particles[0]), to = place(setup.plan, after.particles[0]);
  EXPECT_EQ(to[2] - from[2], after.particles[0].u[2]);
}

RunError fault_of(const Setup& setup, int steps) {
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  try {
    for (int k = 0; k < steps; ++k) golden.step();
  } catch (const RunError& e) {
    return e;
  }
  return {Fault::none, 0, 0, 0, 0, ""};
}

TEST(GoldenFaults, EachNamesItsParticle) {
  const auto out = block({.size = {1, 1, 1}, .speed = 0.3, .margin = 0.1});
  const RunError left = fault_of(out, 500);
  EXPECT_GE(left.fault, Fault::left_x);
  EXPECT_EQ(left.number, 0);

  Arch narrow;
  narrow.widths.velocity_bits = 22;
  const RunError fast = fault_of(block({.jitter = 0.2, .speed = 0}, narrow), 50);
  EXPECT_EQ(fast.fault, Fault::velocity);
  EXPECT_FALSE(fits(fast.number, 22));
  EXPECT_TRUE(fits(fast.number, 24));

  narrow = {};
  narrow.widths.sum_bits = 16;
  const RunError sum = fault_of(block({.jitter = 0.1}, narrow), 50);
  EXPECT_EQ(sum.fault, Fault::sum);
  EXPECT_EQ(sum.step, 0u);
  EXPECT_FALSE(fits(sum.number, 16));
  EXPECT_STREQ(std::string(sum.what()).substr(0, 13).c_str(), "step 0, cell ");

  narrow = {};
  narrow.widths.relative_velocity_bits = 10;
  EXPECT_EQ(fault_of(block({.speed = 0.1, .damping = 0.1}, narrow), 5).fault, Fault::relative_velocity);

  narrow = {};
  narrow.widths.displacement_bits = 20;
  EXPECT_EQ(fault_of(block({.force_held = true}, narrow), 500).fault, Fault::displacement);
}

TEST(GoldenFaults, CapacityHoldsAtTheLimitAndStopsOneBeyond) {
  // 4 particles in a cell meet a fifth that flies in along x.
  Scene scene = test::block_scene({.size = {1, 1, 1}, .jitter = 0, .speed = 0, .margin = 3});
  scene.body.x.push_back(Vec3(-1.5, 0.3, 0.3));
  scene.body.v.push_back(Vec3(0.8, 0, 0));
  scene.body.type.push_back(0);
  Arch arch;
  arch.capacity = 5;
  EXPECT_EQ(fault_of(make_setup(scene, arch), 12).fault, Fault::none);
  arch.capacity = 4;
  const RunError full = fault_of(make_setup(scene, arch), 12);
  EXPECT_EQ(full.fault, Fault::full_x);
  EXPECT_EQ(full.number, 4);
  EXPECT_EQ(full.particle, 4u);
  arch.capacity = 3;
  try {
    make_setup(scene, arch);
    FAIL() << "a full cell was accepted";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "a cell would hold 4 particles: its capacity is 3\n  hint: set node.capacity to at least 4 "
                 "in the arch file");
  }
}

}  // namespace
}  // namespace cuboct
