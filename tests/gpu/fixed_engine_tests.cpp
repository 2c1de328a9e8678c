// SPDX-License-Identifier: MIT
// The fixed gpu engine holds golden's bits, whatever the slabs, blocks and cuts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/analysis/measure.h"
#include "tests/gpu/beside_golden.h"
#include "tests/support/block.h"

namespace cuboct::test {
namespace {

gpu::Options slabs(int count, int block = 128) {
  gpu::Options options;
  options.devices.assign(static_cast<size_t>(count), 0);
  options.block = block;
  if (block == 256) options.together = 0;  // few particles in a launch for each step, too
  return options;
}

constexpr int kBlocks[] = {32, 128, 256};
constexpr Cut kCuts[] = {Cut::whole, Cut::single, Cut::random};

// Every number of slabs that fits, each with another block and cut.
void compare_all(const Case& c, uint64_t seed, Met& met) {
  const GoldenPath golden = golden_path(c);
  const int most = most_slabs(c.setup.plan);
  for (int s = 1; s <= most; ++s) {
    const auto k = static_cast<size_t>(s) + seed;
    compare(c, golden, slabs(s, kBlocks[k % 3]), kCuts[k % 3], seed, met);
    if (s == 1 || seed % 4 == 0)
      compare(c, golden, slabs(s, kBlocks[(k + 2) % 3]), kCuts[(k + 1) % 3], seed + 1, met);
    if (testing::Test::HasFatalFailure()) return;
  }
}

class FixedCases : public testing::TestWithParam<std::string> {};

TEST_P(FixedCases, HoldGoldensBits) {
  const Case c = make_case(GetParam());
  Met met;
  compare_all(c, 0, met);
  EXPECT_GT(met.updates, 0u);
}

INSTANTIATE_TEST_SUITE_P(Gpu, FixedCases, testing::ValuesIn(case_names()),
                         [](const auto& p) { return p.param; });

struct Named {
  std::string scene;
  uint64_t steps;
  int slabs;  // of the second run
};

class FixedScenes : public testing::TestWithParam<Named> {};

TEST_P(FixedScenes, HoldGoldensBits) {
  const Scene scene = read_scene(std::string(CUBOCT_SOURCE_DIR) + "/scenes/" + GetParam().scene + ".toml");
  const Case c{GetParam().scene, make_setup(scene, {}), GetParam().steps, scene};
  const GoldenPath golden = golden_path(c);
  ASSERT_EQ(golden.hashes.size(), c.steps);
  ASSERT_LE(GetParam().slabs, most_slabs(c.setup.plan));
  Met met;
  compare(c, golden, slabs(1), Cut::whole, 1, met);
  compare(c, golden, slabs(GetParam().slabs), Cut::random, 2, met);
}

INSTANTIATE_TEST_SUITE_P(Gpu, FixedScenes,
                         testing::Values(Named{"coupon", 12, 4}, Named{"hot_cluster", 200, 2},
                                         Named{"lj_block", 30, 1}, Named{"two_types", 30, 2},
                                         Named{"undamped_block", 30, 1}, Named{"sheet", 60, 2}),
                         [](const auto& p) { return p.param.scene; });

TEST(FixedRandom, HoldGoldensBits) {
  Met met;
  for (uint64_t seed = 1; seed <= 120; ++seed) {
    compare_all(seed % 5 == 0 ? random_flat_case(seed) : random_case(seed), seed, met);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(met.runs, 200u);
  EXPECT_GT(met.crossed, 400u);
  EXPECT_GT(met.faults, 5u);
}

TEST(FixedRandom, BarsOfSeveralSlabsHoldGoldensBits) {
  Met met;
  int refused = 0, wide = 0, rings = 0, four = 0, pd = 0, weighted = 0;
  for (uint64_t seed = 1; seed <= 220; ++seed) {
    Case c;
    try {
      c = random_bar(seed);
    } catch (const InputError&) {
      ++refused;
      continue;
    }
    const Plan& plan = c.setup.plan;
    wide += plan.rule.widths.velocity_bits > 32;
    for (int a = 0; a < 3; ++a) rings += plan.lattice.period()[a] > 0;
    pd += plan.rule.pd;
    weighted += plan.rule.weighted;
    four += most_slabs(plan) == 4;
    compare_all(c, seed, met);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(met.runs, 200u) << refused << " refused";
  EXPECT_GT(wide, 20);
  EXPECT_GT(rings, 20);
  EXPECT_GT(four, 20);
  EXPECT_GT(pd, 10);
  EXPECT_GT(weighted, 20);
  EXPECT_GT(met.crossed, 5000u);
  EXPECT_GT(met.faults, 20u);
  EXPECT_GT(met.halo, 10000u);
}

// Cells a thousand cutoffs wide, where any skin is below what an anchor tells: one particle comes to stand in
// the middle of its anchor's step, within the reach of another that stands in the middle of its own.
TEST(FixedRandom, SkinsBelowTheAnchorsAreNotTrusted) {
  Case c{"wide cells", {}, 20, {}};
  c.scene = block_scene({.size = {1, 1, 1}, .cutoff = 1.2, .jitter = 0, .speed = 0, .margin = 1});
  c.scene.body = {};
  c.scene.body.x = {Vec3(0, 0, 0), Vec3(1.1, 0, 0)};
  c.scene.body.v.assign(2, Vec3::Zero());
  c.scene.body.type = {0, 1};
  c.scene.rule.types = {{.name = "moved"}, {.name = "free"}};
  c.scene.rule.types[0].imposed = {true, true, true};
  c.scene.rule.types[0].velocity = Vec3(1, 0, 0);
  Arch arch;
  arch.cell_edge = 1200;
  Widths& w = arch.widths;
  w.position_frac = 28, w.guard = 12, w.velocity_bits = w.sum_bits = 41, w.difference_frac = 24;
  c.setup = make_setup(c.scene, arch);
  constexpr int64_t kStep = int64_t{1} << 18, kMiddle = 300 * kStep + kStep / 2, kMove = kStep * 3 / 10;
  auto& particles = c.setup.initial.particles;
  ASSERT_EQ(particles[0].cell, particles[1].cell);
  c.setup.plan.rule.types[0].velocity = {kMove << 12, 0, 0};
  particles[0].v = {kMove << 12, 0, 0};
  particles[0].x = {kMiddle - kMove, kMiddle, kMiddle};
  particles[1].x = {kMiddle + kStep, kMiddle, kMiddle};  // 0.977 of a thousandth
  const GoldenPath golden = golden_path(c);
  ASSERT_NE(golden.last.particles[1].v, (Int3{}));
  Met met;
  compare(c, golden, slabs(1), Cut::whole, 1, met);
}

// Two particles that meet head on, from all distances around what the first lists reach: each of the two has
// gone less far than the list allows when they come within the cutoff.
TEST(FixedRandom, FurtherPartnersComeIntoReach) {
  Met met;
  for (int k = 0; k < 40; ++k) {
    Case c{"head on " + std::to_string(k), {}, 60, {}};
    c.scene =
        block_scene({.size = {1, 1, 1}, .cutoff = 1.2, .dt = 0.05, .jitter = 0, .speed = 0, .margin = 1});
    c.scene.body = {};
    c.scene.body.x = {Vec3(0, 0, 0), Vec3(1.2 * (1.06 + 0.001 * k), 0, 0)};
    c.scene.body.v = {Vec3(0.021, 0, 0), Vec3(-0.021, 0, 0)};
    c.scene.body.type = {0, 0};
    Arch arch;
    Widths& w = arch.widths;
    w.position_frac = 28, w.guard = 12, w.velocity_bits = w.sum_bits = 41, w.difference_frac = 24;
    c.setup = make_setup(c.scene, arch);
    compare(c, golden_path(c), slabs(1), Cut::whole, 1, met);
    if (HasFatalFailure()) return;
  }
  EXPECT_LT(met.lists, 10 * met.runs);
}

// Two on springs that swing to and fro about a distance just outside the cutoff, in and out of what near
// lists reach: each is soon back where the pair list found it, though not where the near list did.
TEST(FixedRandom, DisplacementsCountFromWhereTheNearListWasMade) {
  Met met;
  for (int k = 0; k < 40; ++k) {
    Case c{"swing " + std::to_string(k), {}, 200, {}};
    c.scene =
        block_scene({.size = {1, 1, 1}, .cutoff = 1.2, .dt = 0.05, .jitter = 0, .speed = 0, .margin = 1});
    c.scene.body = {};
    const double far = 0.02 * 1.2, turn = 0.25 + 0.005 * k;  // amplitude; radians a step
    ParticleType& type = c.scene.rule.types[0];
    type.pd = true;
    type.kp = turn * turn / (0.05 * 0.05) * c.scene.rule.mass;
    c.scene.body.x = {Vec3(0, 0, 0), Vec3(1.2 * 1.03, 0, 0)};
    c.scene.body.v = {Vec3(-far * turn / 0.05, 0, 0), Vec3(far * turn / 0.05, 0, 0)};
    c.scene.body.type = {0, 0};
    Arch arch;
    Widths& w = arch.widths;
    w.position_frac = 28, w.guard = 12, w.velocity_bits = w.sum_bits = 41, w.difference_frac = 24;
    w.displacement_bits = 40;
    c.setup = make_setup(c.scene, arch);
    const GoldenPath golden = golden_path(c);
    ASSERT_EQ(golden.hashes.size(), c.steps) << golden.fault->what();
    compare(c, golden, slabs(1), Cut::whole, 1, met);
    if (HasFatalFailure()) return;
  }
  EXPECT_LE(met.lists, 3 * met.runs);
}

TEST(FixedFaults, AreGoldensWhateverTheSlabs) {
  Met met;
  uint64_t runs = 0;
  for (const Fault fault : all_faults()) {
    const Case c = fault_case(fault);
    const GoldenPath golden = golden_path(c);
    ASSERT_TRUE(golden.fault) << c.name;
    ASSERT_EQ(golden.fault->fault, fault);
    for (int s = 1; s <= std::min(3, most_slabs(c.setup.plan)); ++s)
      for (const Cut cut : kCuts) {
        compare(c, golden, slabs(s), cut, 7, met);
        if (HasFatalFailure()) return;
        ++runs;
      }
  }
  EXPECT_EQ(met.faults, runs);
  EXPECT_GE(runs, 33u);
}

// A gas that damps and at last collides faster than its relative velocities are wide, and another whose cells
// run full: most have several particles at fault, of which golden names one.
TEST(FixedFaults, OfGasesAreGoldens) {
  Met met;
  for (uint64_t seed = 1; seed <= 16; ++seed) {
    Case c{"gas " + std::to_string(seed), {}, 100, {}};
    c.scene = block_scene({.size = {12, 3, 3},
                           .cutoff = 1.4,
                           .dt = 0.1,
                           .jitter = 0.1,
                           .speed = 0.8,
                           .damping = seed % 2 == 0 ? 0.02 : 0,
                           .seed = seed});
    for (int a = 0; a < 3; ++a) {
      c.scene.periodic.origin[a] = -0.3;
      c.scene.periodic.extent[a] = (a == 0 ? 12 : 3) * std::sqrt(2.0);
    }
    Arch arch;
    arch.widths = Widths();  // as they are, not as the gas asks for
    arch.capacity = seed % 2 == 0 ? 60 : 9;
    c.setup = make_setup(c.scene, arch);
    ASSERT_EQ(most_slabs(c.setup.plan), 3);
    const GoldenPath golden = golden_path(c);
    for (int s = 1; s <= 3; ++s) {
      compare(c, golden, slabs(s), kCuts[(seed + static_cast<uint64_t>(s)) % 3], seed, met);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GE(met.faults, 40u);
  EXPECT_GT(met.crossed, 10000u);
}

// Cells that are as full as they may be, and particles that come and go, but never one too many.
TEST(FixedFaults, FullCellsAreNoFault) {
  Met met;
  uint64_t near_misses = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    Case c{"near miss " + std::to_string(seed), {}, 120, {}};
    c.scene = block_scene({.size = {12, 2, 2}, .jitter = 0.05, .speed = 0.15, .margin = 2, .seed = seed});
    // The least capacity with which golden comes through.
    GoldenPath golden;
    int capacity = 4;
    for (;; ++capacity) {
      Arch arch;
      arch.capacity = capacity;
      try {
        c.setup = make_setup(c.scene, arch);
      } catch (const InputError&) {
        continue;
      }
      golden = golden_path(c);
      if (!golden.fault) break;
    }
    Met one;
    for (int s = 1; s <= most_slabs(c.setup.plan); ++s) {
      compare(c, golden, slabs(s), Cut::whole, seed, one);
      if (HasFatalFailure()) return;
    }
    near_misses += one.golden_steps;
    met.crossed += one.crossed;
    // The step before a cell is full asks golden; others do not.
    EXPECT_LT(one.golden_steps, one.runs * c.steps / 4) << c.name;
  }
  EXPECT_GT(near_misses, 0u);
  EXPECT_GT(met.crossed, 100u);
}

// What is read is what the host measures: forces to the bit, sums of doubles but for their order.
TEST(FixedReading, IsWhatTheHostMeasures) {
  uint64_t read = 0;
  for (const char* name : {"rich_damped", "rich_force_held", "rich_ring", "flat_rich_damped", "hot_gas",
                           "periodic_27", "held_and_moved", "force_held", "damped"}) {
    const Case c = make_case(name);
    const Plan& plan = c.setup.plan;
    for (int s = 1; s <= most_slabs(plan); ++s) {
      SCOPED_TRACE(std::string(name) + ", " + std::to_string(s) + " slabs");
      const auto engine = gpu::make_fixed_engine(c.scene, plan, c.setup.initial, slabs(s));
      std::vector<uint32_t> ids;
      for (uint32_t id = 1; id < plan.particles; id += 2) ids.push_back(id);
      engine->probe(ids);
      for (int k = 0; k < 4; ++k) {
        const gpu::Reading reading = engine->read(true);
        const State state = engine->state();
        const std::vector<Int3> kicks = summed_kicks(plan.rule, plan.lattice, state, 1);
        EXPECT_EQ(reading.step, state.step);
        ASSERT_EQ(reading.x.size(), ids.size());
        for (size_t n = 0; n < ids.size(); ++n) {
          const uint32_t id = ids[n];
          ASSERT_EQ(reading.force[n], force_of(plan.rule, kicks[id])) << "particle " << id;
          Vec3 away = reading.x[n] - position_of(plan.rule, plan.lattice, plan.origin, state.particles[id]);
          for (int a = 0; a < 3; ++a)
            if (const double extent = c.scene.periodic.extent[a]; extent > 0)
              away[a] -= extent * std::round(away[a] / extent);
          ASSERT_LE(away.norm(), 1e-12 * plan.rule.cell_edge * 100) << "particle " << id;
          ++read;
        }
        const Energies e = energies(c.scene.rule, plan.rule, plan.lattice, plan.origin, state, kicks, 1);
        EXPECT_NEAR(reading.energies.kinetic, e.kinetic, 1e-9 * e.kinetic);
        EXPECT_NEAR(reading.energies.potential, e.potential, 1e-9 * std::abs(e.potential));
        EXPECT_NEAR(reading.energies.gravity, e.gravity, 1e-9 * std::abs(e.gravity) + 1e-15);
        EXPECT_NEAR(reading.largest_speed,
                    largest_speed(plan.rule, state) * plan.rule.cell_edge / plan.rule.dt, 1e-12);
        const double trace = virial_stress(plan.rule, plan.lattice, state, 1.0, 1).trace();
        EXPECT_NEAR(reading.virial, -trace, 1e-9 * (std::abs(trace) + std::abs(e.potential)));
        if (HasFailure()) return;
        engine->advance(6);
      }
    }
  }
  EXPECT_GT(read, 1000u);
}

}  // namespace
}  // namespace cuboct::test
