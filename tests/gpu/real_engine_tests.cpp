// SPDX-License-Identifier: MIT
// The real gpu engines: doubles beside the reference, and the same bits whatever the slabs, blocks and cuts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "emu/gpu/engine.h"
#include "model/analysis/measure.h"
#include "model/base/error.h"
#include "model/contract/law.h"
#include "model/real/reference.h"
#include "tests/fcc_block.h"
#include "tests/support/dice.h"

namespace cuboct::gpu {
namespace {

constexpr double kPitch = 1e-3;                        // m, of the solids
constexpr double kSigma = 3.4e-10, kArgon = 1.65e-21;  // m, J

Options slabs(int count, int block = 128) {
  Options options;
  options.devices.clear();
  for (int s = 0; s < count; ++s) options.devices.push_back(s);
  options.block = block;
  return options;
}

Body fcc_bar(const Cell& cells, double pitch) {
  Body body;
  const double half = pitch / std::numbers::sqrt2;
  for (int z = 0; z < 2 * cells[2]; ++z)
    for (int y = 0; y < 2 * cells[1]; ++y)
      for (int x = 0; x < 2 * cells[0]; ++x)
        if ((x + y + z) % 2 == 0) body.x.push_back(half * Vec3(x, y, z));
  body.v.assign(body.size(), Vec3::Zero());
  body.type.assign(body.size(), 0);
  return body;
}

struct Trial {
  std::string name;
  Scene scene;
  uint64_t steps = 0;
};

Trial solid(const Cell& cells, bool ring, bool full) {
  Trial run{fmt::format("solid{}{}", ring ? " ring" : "", full ? " full" : ""), {}, 150};
  Rule& rule = run.scene.rule;
  rule = test::simple_rule(preset_law("ductile", kPitch, 1e3), 1e-6, 3e-6);
  Body& body = run.scene.body = fcc_bar(cells, kPitch);
  test::shake(body, 0.03 * kPitch, 3.0, 5);
  if (ring) run.scene.periodic.extent = kPitch * std::numbers::sqrt2 * Vec3(cells[0], cells[1], cells[2]);
  if (!full) return run;
  rule.damping.coefficient = 0.2 * std::sqrt(1e3 * 1e-6);
  rule.strength = {{1.0, 0.7}, {0.7, 1.9}};
  ParticleType gravity = rule.types[0], held = rule.types[0], moved = rule.types[0], other = rule.types[0];
  gravity.gravity = Vec3(10, -20, 30);
  other.material = held.material = 1;
  held.pd = true;
  held.kp = 300, held.kd = 0.003;
  held.velocity = Vec3(0.3, 0.1, -0.2);
  moved.imposed = {true, false, true};
  moved.velocity = Vec3(-0.5, 7, 0);
  rule.types.insert(rule.types.end(), {gravity, other, held, moved});
  for (size_t i = 0; i < body.size(); ++i) body.type[i] = static_cast<uint8_t>(i * 7 / 3 % rule.types.size());
  body.u.assign(body.size(), Vec3::Zero());
  return run;
}

// Liquid argon, in reduced units of density 0.8 and of temperature about 1.5 while it melts.
Trial melt(const Cell& cells, uint64_t steps) {
  Trial run{"melt", {}, steps};
  run.scene.rule = test::simple_rule(
      lennard_jones(kArgon, kSigma, 2.5 * kSigma, 0.6 * kSigma, Smoothing::none), 6.6e-26, 1e-14);
  const double pitch = std::cbrt(std::numbers::sqrt2 / 0.8) * kSigma;
  run.scene.body = fcc_bar(cells, pitch);
  run.scene.periodic.extent = pitch * std::numbers::sqrt2 * Vec3(cells[0], cells[1], cells[2]);
  test::shake(run.scene.body, 0.1 * kSigma, 450, 3);
  return run;
}

// Two blocks collide in the open; single particles, faster than a slab is thick, fly past them and far away.
Trial crash() {
  Trial run = solid({4, 4, 3}, false, false);
  run.name = "crash";
  run.steps = 250;
  Body& body = run.scene.body;
  const size_t n = body.size();
  const double speed = 0.05 * kPitch / run.scene.rule.dt;
  for (size_t i = 0; i < n; ++i) {
    body.x.push_back(body.x[i] + kPitch * Vec3(9, 0.7, 0.4));
    body.v.push_back(body.v[i] - Vec3(speed, 0, 0));
    body.type.push_back(0);
    body.v[i] += Vec3(speed, 0, 0);
  }
  for (int k = 0; k < 6; ++k) {
    body.x.push_back(kPitch * Vec3(2.0 * k, -2.5 - k, 3.0 + 3 * k));
    body.v.push_back(kPitch / run.scene.rule.dt * Vec3(k % 2 == 0 ? 8.3 : -14.1, -0.2 * k, 0.4));
    body.type.push_back(0);
  }
  return run;
}

// All move as one, by several planes of cells at each step: no slab keeps a particle.
Trial flight() {
  Trial run = solid({14, 12, 12}, false, false);
  run.name = "flight";
  run.steps = 6;
  for (Vec3& v : run.scene.body.v) v += kPitch / run.scene.rule.dt * Vec3(5.3, 0.1, 0);
  return run;
}

std::unique_ptr<Engine> engine_of(const Trial& run, Arithmetic arithmetic, const Options& options) {
  return make_real_engine(run.scene, run.scene.body, arithmetic, options);
}

void expect_same(const Body& a, const Body& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_EQ(a.u.size(), b.u.size());
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a.x[i], b.x[i]) << "particle " << i;
    ASSERT_EQ(a.v[i], b.v[i]) << "particle " << i;
    ASSERT_TRUE(a.u.empty() || a.u[i] == b.u[i]) << "particle " << i;
    ASSERT_EQ(a.type[i], b.type[i]);
  }
}

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

// How far the reference gets from itself when all its particles are moved by parts in 10^15 of a cutoff: what
// a rounding grows to.
double growth(const Trial& run) {
  const double cutoff = run.scene.rule.law->cutoff();
  Reference one(run.scene.rule, run.scene.body, run.scene.periodic);
  Body moved = run.scene.body;
  std::mt19937_64 random(1);
  for (Vec3& x : moved.x) x += 1e-15 * cutoff * test::random_vector(random);
  Reference other(run.scene.rule, moved, run.scene.periodic);
  one.step(run.steps), other.step(run.steps);
  return farthest(one.body().x, other.body().x) / cutoff;
}

// Positions, in cutoffs, and velocities, in cutoffs per step, beside the reference after the run: a sum of
// roundings, of some 10^-16 at each step, each of which grows as the run makes it.
void compare(const Trial& run, int count) {
  SCOPED_TRACE(fmt::format("{}, {} slabs", run.name, count));
  const double grown = growth(run), tolerance = 1e-13 + 20 * grown;
  const auto engine = engine_of(run, Arithmetic::float64, slabs(count));
  Reference reference(run.scene.rule, run.scene.body, run.scene.periodic);
  engine->advance(run.steps);
  reference.step(run.steps);
  const Body found = engine->body();
  const Body& expected = reference.body();
  const double cutoff = run.scene.rule.law->cutoff(), dt = run.scene.rule.dt;
  EXPECT_LE(farthest(found.x, expected.x) / cutoff, tolerance);
  EXPECT_LE(farthest(found.v, expected.v) * dt / cutoff, tolerance);
  ASSERT_EQ(found.u.size(), expected.u.size());
  EXPECT_LE(farthest(found.u, expected.u) / cutoff, tolerance);
  EXPECT_EQ(found.type, expected.type);
  EXPECT_GT(engine->counters().list_builds, run.steps / 30);
  if (testing::Test::HasFailure()) return;
  // What is read off it, at the reference's own state but for that.
  std::vector<uint32_t> ids;
  for (uint32_t i = 0; i < found.size(); i += 3) ids.push_back(i);
  engine->probe(ids);
  const Reading reading = engine->read(true);
  EXPECT_EQ(reading.step, run.steps);
  const std::vector<Vec3> forces = reference.forces();
  double largest = 0;
  for (const Vec3& f : forces) largest = std::max(largest, f.norm());
  for (size_t k = 0; k < ids.size(); ++k) {
    EXPECT_EQ(reading.x[k], found.x[ids[k]]) << "particle " << ids[k];
    EXPECT_LE((reading.force[k] - forces[ids[k]]).norm(), 1e3 * tolerance * largest + 1e-12 * largest)
        << "particle " << ids[k];
  }
  const Rule& rule = run.scene.rule;
  double kinetic = 0, gravity = 0, speed = 0, heights = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    const Vec3 v = expected.v[i] + dt / 2 * acceleration(rule, expected, i, forces[i]);
    const double mass = rule.mass_of(found.type[i]);
    kinetic += mass * v.squaredNorm() / 2;
    const double weight = mass * rule.types[found.type[i]].gravity.dot(expected.x[i]);
    gravity -= weight, heights += std::abs(weight);
    speed = std::max(speed, expected.v[i].cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(reading.energies.kinetic, kinetic, 1e-9 * kinetic);
  EXPECT_NEAR(reading.energies.potential, reference.potential_energy(),
              1e-9 * std::abs(reference.potential_energy()));
  EXPECT_NEAR(reading.energies.gravity, gravity, 1e-9 * heights);
  EXPECT_NEAR(reading.largest_speed, speed, 1e-9 * speed);
  Mat3 stress = Mat3::Zero();
  for (const Mat3& s : reference.virial_stress(1.0)) stress += s;
  EXPECT_NEAR(reading.virial, -stress.trace(), 1e-9 * std::abs(reference.potential_energy()) * 50);
}

TEST(GpuDouble, FollowsTheReference) {
  compare(solid({5, 4, 4}, false, false), 1);
  compare(solid({4, 4, 4}, true, false), 1);
  compare(solid({4, 12, 3}, true, true), 3);
  compare(solid({3, 4, 12}, false, true), 4);
  compare(melt({4, 4, 4}, 120), 1);
  compare(melt({14, 4, 4}, 120), 4);
  compare(crash(), 1);
  compare(crash(), 3);
  compare(flight(), 2);
}

// The same bits in calls of one step or of many, in a launch for each step or for many, on any number of
// slabs, with blocks of any size.
void expect_one_run(const Trial& run, Arithmetic arithmetic, int most) {
  SCOPED_TRACE(fmt::format("{}, {}", run.name, to_string(arithmetic)));
  const auto first = engine_of(run, arithmetic, slabs(1));
  first->advance(run.steps);
  first->probe({0, 3, 5});
  const Reading reading = first->read(true);
  const Body expected = first->body();
  ASSERT_TRUE(std::isfinite(expected.x[0].x()));
  for (int count = 1; count <= most; ++count) {
    Options options = slabs(count, count % 2 == 0 ? 32 : 256);
    options.together = 0;  // the first went on in one launch
    const auto engine = engine_of(run, arithmetic, options);
    test::Dice dice(static_cast<uint64_t>(count));
    while (engine->step_count() < run.steps) {
      const uint64_t left = run.steps - engine->step_count();
      engine->advance(count == 2 ? 1 : std::min(left, static_cast<uint64_t>(dice.draw(1, 40))));
      if (dice.chance(20)) engine->probe({0, 3, 5}), engine->read(true);
      if (dice.chance(20)) engine->body();
    }
    SCOPED_TRACE(fmt::format("{} slabs", count));
    expect_same(engine->body(), expected);
    engine->probe({0, 3, 5});
    const Reading found = engine->read(true);
    EXPECT_EQ(found.x, reading.x);
    EXPECT_EQ(found.force, reading.force);
    // Sums go slab by slab.
    EXPECT_NEAR(found.energies.total(), reading.energies.total(), 1e-12 * reading.energies.kinetic);
    EXPECT_EQ(found.largest_speed, reading.largest_speed);
    EXPECT_EQ(engine->counters().list_builds, first->counters().list_builds);
    EXPECT_EQ(engine->counters().listed_pairs, first->counters().listed_pairs);
    EXPECT_EQ(engine->counters().halo_particles > 0, count > 1);
    if (testing::Test::HasFatalFailure()) return;
  }
}

TEST(GpuReal, BitsDoNotKnowOfSlabsBlocksAndCuts) {
  for (const Arithmetic arithmetic : {Arithmetic::float32, Arithmetic::float64}) {
    expect_one_run(solid({4, 12, 3}, true, true), arithmetic, 4);
    expect_one_run(solid({3, 4, 12}, false, true), arithmetic, 4);
    expect_one_run(melt({4, 4, 14}, 200), arithmetic, 4);
    expect_one_run(crash(), arithmetic, 3);
    if (HasFatalFailure()) return;
  }
  expect_one_run(flight(), Arithmetic::float32, 4);
}

// Ways are those of the particles themselves, whoever looks: copies have their anchors in both states.
TEST(GpuReal, NearListsServeAsLongOnSlabs) {
  uint64_t stops = 0;
  for (int k = 0; k < 8; ++k) {
    Trial run = melt({4, 4, 14}, 0);
    for (Vec3& v : run.scene.body.v) v *= 0.3 + 0.15 * k;
    Options one = slabs(1);
    one.together = 0;
    const auto alone = engine_of(run, Arithmetic::float32, one);
    const auto many = engine_of(run, Arithmetic::float32, slabs(4));
    for (uint64_t step = 1; step <= 120; ++step) {
      alone->advance(1), many->advance(1);
      ASSERT_EQ(many->counters().near_stops, alone->counters().near_stops)
          << "run " << k << ", step " << step;
    }
    stops += alone->counters().near_stops;
  }
  EXPECT_GT(stops, 6u);
}

// A free flight in a box that repeats: x - x(0) grows through many periods.
TEST(GpuReal, PositionsAreNotWrapped) {
  Trial run = solid({4, 4, 4}, true, false);
  const Vec3 speed = run.scene.periodic.extent.x() / run.scene.rule.dt * Vec3(0.31, -0.17, 0.05);
  for (Vec3& v : run.scene.body.v) v = speed;
  run.scene.body.x = fcc_bar({4, 4, 4}, kPitch).x;
  const auto engine = engine_of(run, Arithmetic::float64, slabs(1));
  engine->advance(100);
  const Body body = engine->body();
  double most = 0;
  for (size_t i = 0; i < body.size(); ++i)
    most = std::max(most, (body.x[i] - run.scene.body.x[i] - 100 * run.scene.rule.dt * speed).norm());
  EXPECT_LE(most, 1e-9 * kPitch);
  EXPECT_GT(body.x[0].x(), 30 * run.scene.periodic.extent.x());
}

TEST(GpuReal, APositionWithoutBoundsStopsTheRun) {
  for (const int count : {1, 2}) {
    Trial run = solid({8, 3, 3}, false, false);
    run.scene.body.v[17] = Vec3(0, 1e7 * kPitch / run.scene.rule.dt, 0);
    const auto engine = engine_of(run, Arithmetic::float32, slabs(count));
    const Body before = engine->body();
    for (int again = 0; again < 2; ++again) {
      try {
        engine->advance(5);
        FAIL() << "went on";
      } catch (const LostPosition& e) {
        EXPECT_EQ(e.step, 0u);
        EXPECT_EQ(e.particle, 17u);
        EXPECT_STREQ(
            e.what(),
            "step 1: a position leaves all bounds; before it particle 17 was the fastest, at 3.333e+09 m/s");
      }
      EXPECT_EQ(engine->step_count(), 0u);
      expect_same(engine->body(), before);
    }
  }
}

TEST(GpuReal, RefusesABoxOfLessThanTwoCutoffs) {
  Trial run = solid({4, 4, 1}, true, false);
  try {
    engine_of(run, Arithmetic::float32, slabs(1));
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(std::string(e.what()),
              fmt::format("the periodic box is {:g} m long along z, less than two cutoffs ({:g} m)",
                          run.scene.periodic.extent.z(), 2 * run.scene.rule.law->cutoff()));
  }
}

}  // namespace
}  // namespace cuboct::gpu
