// SPDX-License-Identifier: MIT
// Standing waves and ringing beams against the theory of elasticity; the full tables are in
// docs/measured/validation.md, sections 4 and 5.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/analysis/measure.h"
#include "model/real/reference.h"
#include "model/solid/dynamical_matrix.h"
#include "model/trace/figure.h"
#include "tests/golden/scene_with.h"

namespace cuboct {
namespace {

const std::string kScenes = CUBOCT_SOURCE_DIR "/scenes/validation/";
constexpr double kPi = std::numbers::pi;

// rad/s of the equations of motion: leapfrog's steps turn w into sin(w dt/2) = w0 dt/2.
double frequency_of(const std::vector<Curve>& curves, const std::string& curve, double dt) {
  Figure figure;
  figure.kind = Figure::Kind::frequency;
  figure.name = "frequency";
  figure.curve = curve;
  return 2 / dt * std::sin(kPi * value_of(figure, curves, dt) * dt);
}

Scene wave(int cells, double strain) {
  const double length = cells * std::numbers::sqrt2;
  const auto box = [](double low, double high) {
    return fmt::format("{{ shape = \"box\", min = [{}, -9, -9], max = [{}, 9, 9] }}", low, high);
  };
  return test::scene_with(kScenes + "wave.toml",
                          {{"box.cells", fmt::format("[{}, 3, 3]", cells)},
                           {"regions.left", box(0, length / 2)},
                           {"regions.crest", box(length / 12, length * 5 / 12)},
                           {"velocity.0.uniform", fmt::format("[{}, 0, 0]", -strain)},
                           {"velocity.1.uniform", fmt::format("[{}, 0, 0]", 2 * strain)},
                           {"run.duration", fmt::format("{:.6f}", 16 * length)},
                           {"run.probe_every", fmt::format("{}", std::max(1, cells / 5))}});
}

double speed_of(const std::vector<Curve>& curves, const Scene& scene) {
  return frequency_of(curves, "crest.x", scene.rule.dt) * scene.periodic.extent.x() / (2 * kPi);
}

double continuum(const Scene& scene) {
  const double density = scene.rule.mass / fcc_volume(scene.pitch);
  return std::sqrt(elastic_constants(*scene.rule.law, scene.pitch)(0, 0) / density);
}

// Planes along [100] act on their neighbours alone, half a cubic cell s away: w = 2c/s sin(ks/2).
double chain(const Scene& scene, int cells) {
  const double half = kPi / (2 * cells);
  return continuum(scene) * std::sin(half) / half;
}

TEST(Wave, SpeedAlong100IsThatOfElasticityAtDefaultWidths) {
  const Scene scene = wave(50, 1e-3);
  EXPECT_NEAR(continuum(scene), 1, 1e-12);
  const double speed = speed_of(test::curves_of(scene, read_arch(kScenes + "default.toml")), scene);
  fmt::print("default widths, 50 cells: {:.5f} of sqrt(C11/density)\n", speed / continuum(scene));
  // The law's hump stiffens strains of 1e-3 by 0.2 %; 18 value bits know the slope of a bin to 0.2 %.
  EXPECT_NEAR(speed / continuum(scene), 1, 0.01);
}

TEST(Wave, DispersesLikeAChainInWideFormats) {
  for (const int cells : {10, 25}) {
    const Scene scene = wave(cells, 1e-4);
    const double speed = speed_of(test::curves_of(scene, read_arch(kScenes + "wide.toml")), scene);
    fmt::print("wide formats, {} cells: {:.5f}, chain {:.5f}\n", cells, speed / continuum(scene),
               chain(scene, cells) / continuum(scene));
    // The hump, in proportion to the strain: 0.02 %. The chain is 0.4 % and 0.07 % below the continuum.
    EXPECT_NEAR(speed / chain(scene, cells), 1, 5e-4);
  }
}

TEST(Wave, DispersesLikeAChainInTheReference) {
  const int cells = 10;
  const Scene scene = wave(cells, 1e-4);
  Reference run(scene.rule, scene.body, scene.periodic, Integrator::semi_implicit_euler);
  ProbeMeter meter(scene.probes, scene.periodic, scene.body.x);
  const std::vector<Vec3> no_force(scene.body.size(), Vec3::Zero());
  for (uint64_t step = 0; step <= scene.steps; step += scene.probe_every) {
    meter.add({step, run.body().x, no_force, {}});
    run.step(scene.probe_every);
  }
  EXPECT_NEAR(speed_of(meter.curves(), scene) / chain(scene, cells), 1, 5e-4);
}

// First bending frequency of a beam of `count` particles along its longer rows, over Euler and Bernoulli's
// 22.3733/L^2 sqrt(EI/(mass per length)). scenes/validation/beam.toml has 12 rows of `count` bonds and 6 of
// one less, each of stiffness * pitch = 1 per strain and of mass 1 per length, at z = -+sqrt(2), 0 (4 rows
// each), -+sqrt(1/2) (3 rows each).
double bending(int count) {
  const auto box = [](double low, double high) {
    return fmt::format("{{ shape = \"box\", min = [{}, -9, -9], max = [{}, 9, 9] }}", low, high);
  };
  const double length = (12 * count + 6 * (count - 1)) / 18.0, second_moment = 2 * 4 * 2.0 + 2 * 3 * 0.5;
  const double euler = 22.3733 / (length * length) * std::sqrt(second_moment / 18);
  const double middle = (count - 1) / 2.0, end = count / 50.0, period = 2 * kPi / euler;
  const Scene scene =
      test::scene_with(kScenes + "beam.toml",
                       {{"geometry.max", fmt::format("[{}, 3.1, 2.93]", count - 0.9)},
                        {"regions.inner", box(middle - count / 4.0 + 0.1, middle + count / 4.0 - 0.1)},
                        {"regions.middle", box(middle - end - 0.3, middle + end + 0.3)},
                        {"regions.ends", fmt::format("{{ shape = \"difference\", from = {}, minus = [{}] }}",
                                                     box(-1, count), box(end, count - 1 - end))},
                        {"run.duration", fmt::format("{:.3f}", 8 * period)},
                        {"run.probe_every", "20"}});
  std::vector<Curve> curves = test::curves_of(scene, read_arch(kScenes + "default.toml"));
  Curve bend = test::curve_named(curves, "middle.z");
  const Curve& ends = test::curve_named(curves, "ends.z");
  bend.name = "bend";
  for (size_t k = 0; k < bend.value.size(); ++k) bend.value[k] -= ends.value[k];
  return frequency_of({bend}, "bend", scene.rule.dt) / euler;
}

TEST(Beam, BendsLikeBeamTheoryAsItGetsSlender) {
  const double stout = bending(32), slender = bending(52);
  fmt::print("length/height 8.9: {:.4f} of Euler and Bernoulli's frequency; 14.5: {:.4f}\n", stout, slender);
  // Timoshenko's beam, which knows shear and rotary inertia: 0.9615 and 0.9848.
  EXPECT_NEAR(stout, 0.9615, 0.01);
  EXPECT_NEAR(slender, 1, 0.03);
  EXPECT_GT(slender, stout + 0.01);
}

}  // namespace
}  // namespace cuboct
