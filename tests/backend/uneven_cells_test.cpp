// SPDX-License-Identifier: MIT
// Boxes that no cube divides: cells with an edge of its own along each axis, on golden and the lattice
// engine.
#include <gtest/gtest.h>

#include <cmath>

#include "hw/plan/setup.h"
#include "model/analysis/measure.h"
#include "model/contract/golden.h"
#include "model/contract/law_function.h"
#include "model/real/reference.h"
#include "tests/backend/against_golden.h"
#include "tests/support/block.h"
#include "tests/support/refused_with.h"

namespace cuboct::test {
namespace {

TEST(UnevenCells, LatticeEqualsGolden) {
  Count count;
  size_t uneven = 0;
  for (uint64_t seed = 1; seed <= 24; ++seed) {
    const Case c = uneven_case(seed);
    uneven += !c.setup.plan.rule.cubic();
    for (const int threads : {1, 3})
      compare(c, {.threads = threads, .quiescence = seed % 2 == 0, .simd = {}}, count);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(uneven, 24u);
  EXPECT_GT(count.updates, 200000u);
  EXPECT_GT(count.moves, 1000u);
}

Scene warm_block(double cutoff, double accuracy) {
  Scene scene = block_scene({.size = {5, 4, 6}, .cutoff = cutoff, .jitter = 0.03, .speed = 0.1});
  for (int a = 0; a < 3; ++a) {
    scene.periodic.origin[a] = -0.3;
    scene.periodic.extent[a] = (a == 0 ? 5 : a == 1 ? 4 : 6) * std::sqrt(2.0);
  }
  scene.accuracy = accuracy;
  return scene;
}

// The farthest that golden's particles are from those of doubles after some steps, over the pitch.
double off_by(const Scene& scene, int difference_frac) {
  Arch arch;
  arch.capacity = 60;
  arch.widths.difference_frac = difference_frac;
  arch.widths.position_frac = difference_frac + 6;
  arch.table.degree = 2;
  arch.table.index_bits = 12;
  const Plan plan = plan_of(scene, arch, CellForm::any);
  EXPECT_FALSE(plan.rule.cubic());
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity,
                to_fixed(scene.body, plan.rule, plan.lattice, plan.origin));
  Reference doubles(scene.rule, scene.body, scene.periodic, {});
  for (int step = 0; step < 20; ++step) golden.step(), doubles.step();
  const Body body = to_real(golden.state(), plan.rule, plan.lattice, plan.origin);
  double most = 0;
  for (size_t id = 0; id < body.size(); ++id)
    most = std::max(most, nearest_image(body.x[id] - doubles.body().x[id], scene.periodic).norm());
  return most;
}

// Differences that are 2^6 times finer leave a difference to doubles that is 2^6 times less, but for the
// table: an edge that counted wrongly would leave it as it is.
TEST(UnevenCells, FinerIntegersComeNearerToDoubles) {
  const Scene scene = warm_block(1.6, 1e-3);
  const double coarse = off_by(scene, 12), fine = off_by(scene, 18);
  EXPECT_LT(coarse, 20 * std::ldexp(1.0, -12));
  EXPECT_LT(fine, coarse / 16);
}

TEST(UnevenCells, MomentumIsKeptAndTimeRunsBack) {
  const Scene scene = warm_block(1.6, 1e-3);
  const Plan plan = plan_of(scene, {}, CellForm::any);
  const State begin = to_fixed(scene.body, plan.rule, plan.lattice, plan.origin);
  const auto kick_back = [](State state) {
    for (Particle& p : state.particles)
      for (int64_t& v : p.v) v = -v;
    return state;
  };
  Golden golden(plan.rule, plan.lattice, plan.arch.capacity, begin);
  for (int step = 0; step < 30; ++step) golden.step();
  const State there = golden.state();
  EXPECT_EQ(momentum(plan.rule, there), momentum(plan.rule, begin));
  EXPECT_NE(there.particles[7].x, begin.particles[7].x);
  // Positions after n steps with the velocities that the next step drifts by.
  golden.step();
  State turned = there;
  for (size_t k = 0; k < turned.particles.size(); ++k) turned.particles[k].v = golden.state().particles[k].v;
  Golden back(plan.rule, plan.lattice, plan.arch.capacity, kick_back(turned));
  for (int step = 0; step < 30; ++step) back.step();
  for (size_t k = 0; k < begin.particles.size(); ++k)
    ASSERT_EQ(back.state().particles[k].x, begin.particles[k].x) << "particle " << k;
}

// What is measured of integers is what the doubles have: energies, the box's stress, velocities.
TEST(UnevenCells, EnergiesAndStressAreThoseOfDoubles) {
  const Scene scene = warm_block(1.6, 1e-4);
  const Plan plan = plan_of(scene, {}, CellForm::any);
  const State state = to_fixed(scene.body, plan.rule, plan.lattice, plan.origin);
  const double volume = scene.periodic.extent.prod();
  const std::vector<Int3> kicks = summed_kicks(plan.rule, plan.lattice, state);
  Reference doubles(scene.rule, scene.body, scene.periodic, {});
  const std::vector<Vec3> forces = doubles.forces();
  double strongest = 0, off = 0;
  for (size_t id = 0; id < forces.size(); ++id) {
    strongest = std::max(strongest, forces[id].norm());
    off = std::max(off, (force_of(plan.rule, kicks[id]) - forces[id]).norm());
  }
  EXPECT_LT(off, 1e-3 * strongest);
  const Energies fixed = energies(scene.rule, plan.rule, plan.lattice, plan.origin, state, kicks);
  double potential = 0;
  Mat3 stress = Mat3::Zero();
  for (size_t i = 0; i < scene.body.size(); ++i)
    for (size_t j = i + 1; j < scene.body.size(); ++j) {
      const Vec3 d = nearest_image(scene.body.x[j] - scene.body.x[i], scene.periodic);
      if (d.norm() >= scene.rule.cutoff()) continue;
      potential += scene.rule.law->energy(d.norm());
      stress -= scene.rule.law->force(d.norm()) / d.norm() * d * d.transpose() / volume;
    }
  EXPECT_NEAR(fixed.potential, potential, 1e-5 * std::abs(potential));
  const Mat3 measured = virial_stress(plan.rule, plan.lattice, state, volume);
  EXPECT_LT((measured - stress).norm(), 1e-3 * stress.norm()) << measured << "\n\n" << stress;
}

TEST(UnevenCells, MachinesRefuseThem) {
  const Scene scene = warm_block(1.6, 1e-3);
  EXPECT_EQ(
      refused_with([&] { plan_of(scene, {}); }),
      "no cell edge of at least 1.6 m divides the periodic box 7.07107 x 5.65685 x 8.48528 m into 3 "
      "or more cells per axis\n  hint: use a larger box, or one whose sides have a common part; engines "
      "golden, lattice and gpu need no such part");
  Scene small = warm_block(1.6, 1e-3);
  small.periodic.extent[1] = 4.5;
  EXPECT_EQ(refused_with([&] { plan_of(small, {}, CellForm::any); }),
            "no cell edge of at least 1.6 m divides the periodic box 7.07107 x 4.5 x 8.48528 m into 3 or "
            "more cells "
            "per axis\n  hint: use a larger box: 4.8 m or more along each periodic axis");
}

// Two that stand just a cell apart, in cells as long as the cutoff along x, with a law that ends with a
// force: golden looks into neighbouring cells alone.
TEST(UnevenCells, NobodyMeetsBeyondANeighbouringCell) {
  Count count;
  Scene scene = block_scene({.size = {1, 1, 1}, .jitter = 0, .speed = 0});
  scene.rule.law = hermite_law("ends with a force", Hermite({1, 2.5}, {3, 1}, {-1, -1}), 0.5);
  scene.body = {};
  scene.body.type = {0, 0}, scene.body.v = {Vec3::Zero(), Vec3::Zero()};
  scene.periodic.extent = Vec3(7.5, 8, 9);
  // The first in the last unit of its cell, the second in one of the first units of the cell after the next.
  const double unit = 2.5 * std::ldexp(1.0, -20);
  for (int at = -3; at < 20; ++at) {
    scene.body.x = {Vec3(2.5 - unit, 4, 4.5), Vec3(5 + at * unit, 4, 4.5)};
    Arch arch;
    arch.widths.difference_frac = 16, arch.widths.position_frac = 20;
    Plan plan = plan_of(scene, arch, CellForm::any);
    ASSERT_FALSE(plan.rule.cubic());
    ASSERT_EQ(plan.rule.edges()[0], 2.5);
    State initial = to_fixed(scene.body, plan.rule, plan.lattice, plan.origin);
    const Case c{"two", {std::move(plan), std::move(initial)}, 3};
    compare(c, {.threads = 1, .simd = {}}, count);
    if (HasFatalFailure()) return;
  }
}

// Where a cube divides the box cells are cubes, as on machines.
TEST(UnevenCells, CubesGoBefore) {
  const Scene scene = warm_block(1.4, 1e-3);
  EXPECT_TRUE(plan_of(scene, {}, CellForm::any).rule.cubic());
  EXPECT_EQ(plan_of(scene, {}, CellForm::any).hash, plan_of(scene, {}).hash);
}

}  // namespace
}  // namespace cuboct::test
