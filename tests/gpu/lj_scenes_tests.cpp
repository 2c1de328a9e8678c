// SPDX-License-Identifier: MIT
// The Lennard-Jones scenes of the benchmark are what they are called: one melts, the other stays a crystal.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>
#include <numbers>

#include "gpu_ref/bench_rows.h"
#include "hw/setup.h"
#include "model/reference.h"
#include "model/scene.h"

namespace cuboct::gpu {
namespace {

struct Outcome {
  double temperature = 0;  // kT
  double order =
      0;  // |sum of exp(i k x)|/N for k of the packing's (1, 1, 1) reflection: 1 in a perfect crystal
};

Outcome outcome_of(const BenchScene& bench) {
  const Scene scene = parse_scene(bench.text(), "bench");
  Reference reference(scene.rule, scene.body, scene.periodic);
  reference.step(1000);
  const double n = static_cast<double>(scene.body.size());
  const double k = 2 * std::numbers::pi / (scene.pitch * std::numbers::sqrt2);
  std::complex<double> sum;
  for (const Vec3& x : reference.body().x) sum += std::polar(1.0, k * x.sum());
  return {reference.kinetic_energy() / (1.5 * n), std::abs(sum) / n};
}

// Within the steps that the benchmark waits. A random phase per atom leaves 1/sqrt(864) = 0.034.
TEST(LennardJones, MeltMeltsAndCrystalStays) {
  const BenchScene melt{BenchScene::Kind::melt, 6, false}, solid{BenchScene::Kind::solid, 6, false};
  ASSERT_LE(1000u, melt.settle_steps());
  const Outcome liquid = outcome_of(melt), crystal = outcome_of(solid);
  fmt::print("melt: kT {:.3f}, order {:.3f}; crystal: kT {:.3f}, order {:.3f}\n", liquid.temperature,
             liquid.order, crystal.temperature, crystal.order);
  EXPECT_NEAR(liquid.temperature, 0.71, 0.06);
  EXPECT_LT(liquid.order, 0.15);
  EXPECT_NEAR(crystal.temperature, 0.1, 0.02);
  EXPECT_GT(crystal.order, 0.8);
}

}  // namespace
}  // namespace cuboct::gpu
