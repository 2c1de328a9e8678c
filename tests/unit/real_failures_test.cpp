// SPDX-License-Identifier: MIT
// Where floats fail and the fixed rule does not: coordinates far from the origin, the order of sums. With
// CUBOCT_VERBOSE set the measured tables are printed; docs/plot_failures_real.sh draws them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "hw/plan/setup.h"
#include "model/contract/golden.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"
#include "tests/golden/scene_with.h"

namespace cuboct {
namespace {

using enum Precision;
using MadeSetup = cuboct::Setup;  // testing::Test has a member of that name

bool verbose() { return std::getenv("CUBOCT_VERBOSE") != nullptr; }

std::string scene_path(const std::string& name) {
  return std::string(CUBOCT_SOURCE_DIR) + "/scenes/failures/" + name + ".toml";
}

// The block of far_origin_healthy.toml, moved by `pitches` along each axis.
Scene block_at(double pitches) {
  const auto vector = [](double x) { return fmt::format("[{0:.2f}, {0:.2f}, {0:.2f}]", x); };
  return test::scene_with(scene_path("far_origin_healthy"),
                          {{"packing.offset", vector(pitches + 0.25)}, {"box.origin", vector(pitches)}});
}

double energy(const Reference& run) { return run.kinetic_energy() + run.potential_energy(); }

struct FarOrigin {
  double unit;                     // distance of neighbouring numbers there, in pitches
  double force_median, force_max;  // 2|a-b|/(|a|+|b|) against doubles at the origin
  double energy_start,
      energy_end;  // at steps 0 and 1000, less doubles' at the origin at 0, over the kinetic energy
};

FarOrigin measure(double pitches, Precision precision) {
  const Scene home = block_at(0), scene = block_at(pitches);
  const size_t n = home.body.size();
  FarOrigin result{};
  const double at = pitches + 5;
  const auto narrow = static_cast<float>(at);
  result.unit = precision == float32 ? static_cast<double>(std::nextafter(narrow, 1e30F) - narrow)
                                     : std::nextafter(at, 1e30) - at;

  // Velocity Verlet, whose energy at full steps is level.
  const RealOptions truth{.integrator = Integrator::velocity_verlet};
  Reference state(home.rule, home.body, {}, truth);
  const double start = energy(state), kinetic = state.kinetic_energy();
  state.step(200);
  const std::vector<Vec3> expected = state.forces();
  Body moved = state.body();
  for (Vec3& x : moved.x) x += Vec3::Constant(pitches);
  const std::vector<Vec3> got = Reference(scene.rule, moved, {}, {.precision = precision}).forces();
  std::vector<double> errors;
  for (size_t i = 0; i < n; ++i)
    errors.push_back(2 * (got[i] - expected[i]).norm() / (got[i].norm() + expected[i].norm()));
  std::sort(errors.begin(), errors.end());
  result.force_median = errors[n / 2];
  result.force_max = errors.back();

  Reference run(scene.rule, scene.body, {},
                {.integrator = Integrator::velocity_verlet, .precision = precision});
  result.energy_start = (energy(run) - start) / kinetic;
  run.step(1000);
  result.energy_end = (energy(run) - start) / kinetic;
  return result;
}

uint64_t fixed_hash(const Scene& scene, int steps) {
  const MadeSetup setup = make_setup(scene, Arch{});
  Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
  for (int step = 0; step < steps; ++step) golden.step();
  return hash_of(setup.plan.lattice, golden.state());
}

TEST(RealFailures, FloatsFarFromTheOriginLoseTheirForces) {
  if (verbose()) fmt::print("# precision pitches unit force_median force_max energy_start energy_end\n");
  std::map<std::pair<Precision, double>, FarOrigin> at;
  for (const Precision precision : {float32, float64})
    for (const double pitches : {0.0, 1e2, 1e3, 1e4, 1e5, 1e6}) {
      if (!verbose() && (pitches == 1e2 || pitches == 1e4)) continue;
      const FarOrigin far = at[{precision, pitches}] = measure(pitches, precision);
      if (verbose())
        fmt::print("{} {:g} {:.3g} {:.3g} {:.3g} {:.3g} {:.3g}\n", precision == float32 ? "float" : "double",
                   pitches, far.unit, far.force_median, far.force_max, far.energy_start, far.energy_end);
    }
  // Bonds are stretched by some hundredths of a pitch; a unit of 2^-21 there is 1e-4 of the force, one of
  // 1/128 most of it. The integrator's own energy error is 0.4 % of the kinetic energy.
  EXPECT_LT((at[{float32, 0}].force_median), 1e-4);
  EXPECT_GT((at[{float32, 1e3}].force_median), (30 * at[{float32, 0}].force_median));
  EXPECT_GT((at[{float32, 1e5}].force_median), 0.1);
  EXPECT_LT(std::abs(at[{float32, 0}].energy_end), 1e-2);
  EXPECT_GT((at[{float32, 1e5}].energy_end), 5);
  // Doubles see the same at 2^-29 of it.
  EXPECT_LT((at[{float64, 1e6}].force_median), 1e-6);
  EXPECT_NEAR((at[{float64, 1e6}].energy_end), (at[{float64, 0}].energy_end), 1e-4);
}

// Positions are offsets in cells; where the lattice stands in the world is in no particle.
TEST(RealFailures, TheFixedRuleKnowsNoOrigin) {
  const uint64_t home = fixed_hash(block_at(0), 50);
  for (const double pitches : {1e3, 1e5, 1e6}) EXPECT_EQ(fixed_hash(block_at(pitches), 50), home) << pitches;
  EXPECT_EQ(fixed_hash(read_scene(scene_path("far_origin")), 50), home);
  EXPECT_NE(fixed_hash(block_at(0), 49), home);
}

// rms distance of two runs, in pitches.
double distance(const Reference& a, const Reference& b, double pitch) {
  double sum = 0;
  for (size_t i = 0; i < a.body().size(); ++i) sum += (a.body().x[i] - b.body().x[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.body().size())) / pitch;
}

TEST(RealFailures, SumsInAnotherOrderPartRuns) {
  for (const char* name : {"order_of_sums", "order_of_sums_healthy"}) {
    const bool hot = name == std::string("order_of_sums");
    const Scene scene = read_scene(scene_path(name));
    for (const Precision precision : {float32, float64}) {
      const auto made = [&](uint64_t seed, int threads) {
        return Reference(scene.rule, scene.body, scene.periodic,
                         {.precision = precision, .threads = threads, .order_seed = seed});
      };
      Reference a = made(1, 1), b = made(2, 1), one = made(0, 1), two = made(0, 2), three = made(0, 3);
      std::map<int, double> at;
      int step = 0;
      for (const int next : {1, 10, 100, 200, 400, 600, 1000, 1500, 2000, 3000, 4000, 5000}) {
        if (!verbose() && next > 600) break;
        a.step(next - step);
        b.step(next - step);
        if (next <= 100)
          for (Reference* run : {&one, &two, &three}) run->step(next - step);
        step = next;
        at[step] = distance(a, b, scene.pitch);
        if (verbose())
          fmt::print("{} {} {} {:.3g}\n", name, precision == float32 ? "float" : "double", step, at[step]);
      }
      // This engine sums each particle's pairs in one order whatever the threads.
      EXPECT_EQ(distance(one, two, scene.pitch), 0);
      EXPECT_EQ(distance(one, three, scene.pitch), 0);
      EXPECT_GT(distance(one, a, scene.pitch), 0);
      const double unit = precision == float32 ? 0x1p-24 : 0x1p-53;
      EXPECT_GT(at[10], 0) << name;
      EXPECT_LT(at[10], 100 * unit) << name;
      // Errors that only add up, kicks at random to velocities, grow as t^1.5: by 5 from step 200 to 600.
      // Chaos grows them as exp(2 t): by 25 in these 1.6 units of time.
      const double growth = at[600] / at[200];
      if (hot)
        EXPECT_GT(growth, 12) << name;
      else
        EXPECT_LT(growth, 8) << name;
    }
  }
}

// The same particles in another order of ids, so in another order of every sum.
TEST(RealFailures, TheFixedRuleKnowsNoOrder) {
  Scene scene = read_scene(scene_path("order_of_sums"));
  Scene turned = scene;
  std::reverse(turned.body.x.begin(), turned.body.x.end());
  std::reverse(turned.body.v.begin(), turned.body.v.end());
  std::reverse(turned.body.type.begin(), turned.body.type.end());
  const auto end = [](const Scene& s) {
    const MadeSetup setup = make_setup(s, Arch{});
    Golden golden(setup.plan.rule, setup.plan.lattice, setup.plan.arch.capacity, setup.initial);
    for (int step = 0; step < 60; ++step) golden.step();
    return golden.state();
  };
  const State a = end(scene), b = end(turned);
  const size_t n = a.particles.size();
  ASSERT_EQ(b.particles.size(), n);
  for (size_t i = 0; i < n; ++i) {
    const Particle &one = a.particles[i], &other = b.particles[n - 1 - i];
    EXPECT_EQ(one.cell, other.cell) << i;
    EXPECT_EQ(one.x, other.x) << i;
    EXPECT_EQ(one.v, other.v) << i;
  }
}

}  // namespace
}  // namespace cuboct
