// SPDX-License-Identifier: MIT
// The Lennard-Jones scenes of the benchmark are what they are called: one melts, the other stays a crystal.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "emu/gpu/bench/bench_rows.h"
#include "emu/lattice/run.h"
#include "hw/plan/setup.h"
#include "model/analysis/measure.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"

namespace cuboct::gpu {
namespace {

constexpr uint64_t kSteps = 1000;

struct Outcome {
  double temperature = 0;  // kT
  double order =
      0;  // |sum of exp(i k x)|/N for k of the packing's (1, 1, 1) reflection: 1 in a perfect crystal
};

double order_of(const Scene& scene, const std::vector<Vec3>& positions) {
  const double k = 2 * std::numbers::pi / (scene.pitch * std::numbers::sqrt2);
  std::complex<double> sum;
  for (const Vec3& x : positions) sum += std::polar(1.0, k * x.sum());
  return std::abs(sum) / static_cast<double>(positions.size());
}

Outcome in_doubles(const BenchScene& bench) {
  const Scene scene = parse_scene(bench.text(), "bench");
  Reference reference(scene.rule, scene.body, scene.periodic);
  reference.step(kSteps);
  return {reference.kinetic_energy() / (1.5 * static_cast<double>(scene.body.size())),
          order_of(scene, reference.body().x)};
}

// In the bits of the fixed rule.
Outcome in_integers(const BenchScene& bench) {
  const Scene scene = parse_scene(bench.text(), "bench");
  const Plan plan = plan_of(scene, parse_arch(bench.arch(), "arch"));
  emu::LatticeRun request;
  request.steps = request.hash_every = kSteps;
  request.frames = request.probes = {kSteps};
  request.energies = true;
  request.engine.threads = 1;
  const Trace trace = emu::run_lattice(scene, plan, request).trace;
  EXPECT_FALSE(trace.stop);
  std::vector<Vec3> positions;
  for (const Particle& particle : trace.frames.back().particles)
    positions.push_back(position_of(plan.rule, plan.lattice, plan.origin, particle));
  Outcome outcome{-1, order_of(scene, positions)};
  for (const Curve& curve : trace.curves)
    if (curve.name == "energy.kinetic")
      outcome.temperature = curve.value.back() / (1.5 * static_cast<double>(positions.size()));
  return outcome;
}

// Within the steps that the benchmark waits. A random phase per atom leaves 1/sqrt(864) = 0.034.
TEST(LennardJones, MeltMeltsAndCrystalStays) {
  const BenchScene melt{BenchScene::Kind::melt, 6, false}, solid{BenchScene::Kind::solid, 6, false};
  ASSERT_LE(kSteps, melt.settle_steps());
  for (const auto& [name, outcome_of] :
       {std::pair{"doubles", &in_doubles}, std::pair{"integers", &in_integers}}) {
    const Outcome liquid = outcome_of(melt), crystal = outcome_of(solid);
    SCOPED_TRACE(name);
    fmt::print("{}: melt: kT {:.3f}, order {:.3f}; crystal: kT {:.3f}, order {:.3f}\n", name,
               liquid.temperature, liquid.order, crystal.temperature, crystal.order);
    EXPECT_NEAR(liquid.temperature, 0.71, 0.06);
    EXPECT_LT(liquid.order, 0.15);
    EXPECT_NEAR(crystal.temperature, 0.1, 0.02);
    EXPECT_GT(crystal.order, 0.8);
  }
}

}  // namespace
}  // namespace cuboct::gpu
