// SPDX-License-Identifier: MIT
// Twelve scenes of different kinds and speeds, none with an arch file: what the fixed rule's probes say beside those of
// doubles, of the same integrator and the same steps. With CUBOCT_VERBOSE set it prints the table of
// docs/reference/accuracy.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "emu/lattice/run.h"
#include "hw/setup.h"
#include "model/real_meter.h"

namespace cuboct {
namespace {

// How a curve counts. A run that is chaotic parts from any other in the end, so that only its means can agree.
enum class By : uint8_t { curve, mean };

struct Row {
  std::string scene, curve;
  By by = By::curve;
};

std::vector<uint64_t> looks(const Scene& scene) {
  std::vector<uint64_t> at;
  for (uint64_t step = 0; step <= scene.steps; step += std::max<uint64_t>(1, scene.probe_every)) at.push_back(step);
  if (at.back() != scene.steps) at.push_back(scene.steps);
  return at;
}

std::vector<Curve> in_doubles(const Scene& scene) {
  Reference reference(scene.rule, scene.body, scene.periodic,
                      {.integrator = Integrator::semi_implicit_euler, .threads = 1});
  RealMeter meter(scene, Integrator::semi_implicit_euler, true, true);
  for (const uint64_t step : looks(scene)) {
    while (reference.step_count() < step) reference.step();
    meter.add(reference);
  }
  return meter.curves();
}

const std::vector<double>& values(const std::vector<Curve>& curves, const std::string& name) {
  for (const Curve& curve : curves)
    if (curve.name == name) return curve.value;
  throw std::runtime_error("no curve " + name);
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

class Accuracy : public testing::TestWithParam<Row> {};

// One per cent: what docs/reference/accuracy.md promises of the widths that are taken where no arch file gives any.
TEST_P(Accuracy, IsThatOfDoublesToOnePerCent) {
  const Row& row = GetParam();
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/accuracy/" + row.scene + ".toml");
  const Plan plan = plan_of(scene, {});
  emu::LatticeRun request;
  request.steps = request.hash_every = scene.steps;
  request.energies = request.watch = true;
  request.engine.threads = 1;
  request.probes = looks(scene);
  const emu::LatticeResult run = emu::run_lattice(scene, plan, request);
  ASSERT_FALSE(run.trace.stop) << run.trace.stop->text;
  for (const Finding& finding : run.findings) ADD_FAILURE() << finding.text;

  const std::vector<double> fixed = values(run.trace.curves, row.curve),
                            doubles = values(in_doubles(scene), row.curve);
  ASSERT_EQ(fixed.size(), doubles.size());
  std::vector<double> off;
  for (size_t k = 0; k < fixed.size(); ++k) off.push_back(fixed[k] - doubles[k]);
  const bool by_curve = row.by == By::curve;
  const double error = by_curve ? root_mean_square(off) / root_mean_square(doubles)
                                : std::abs(mean(off) / mean(doubles));
  if (std::getenv("CUBOCT_VERBOSE")) {
    const Widths& w = plan.rule.widths;
    fmt::print("| {} | {}{} | {:.5g} | {:.5g} | {:.2g} | P {}, G {}, D {}, {} strength, W {} |\n", row.scene,
               by_curve ? "" : "mean of ", row.curve, by_curve ? doubles.back() : mean(doubles),
               by_curve ? fixed.back() : mean(fixed), error, w.position_frac, w.guard, w.difference_frac,
               w.strength_bits, w.relative_velocity_frac);
  }
  EXPECT_LT(error, 0.01);
  EXPECT_GT(root_mean_square(doubles), 0);
}

INSTANTIATE_TEST_SUITE_P(
    Each, Accuracy,
    testing::Values(Row{"slow_pull", "middle.x"}, Row{"slow_pull", "grip.force_x"}, Row{"fast_pull", "middle.x"},
                    Row{"fast_pull", "grip.force_x"}, Row{"cantilever", "tip.z"}, Row{"drop", "ball.z"},
                    Row{"drop", "floor.force_z"}, Row{"lj_copper", "energy.kinetic", By::mean},
                    Row{"lj_copper", "pressure", By::mean}, Row{"sheet", "pull.force_x"}, Row{"sheet", "notch.y"},
                    Row{"gas", "energy.kinetic", By::mean}, Row{"gas", "pressure", By::mean},
                    Row{"creep", "end.x"}, Row{"creep", "grip.force_x"}, Row{"vibration", "middle.z"},
                    Row{"impact_wave", "wall.force_x"}, Row{"impact_wave", "middle.x"}, Row{"rotation", "corner.x"},
                    Row{"two_materials", "border.x"}, Row{"two_materials", "grip.force_x"}),
    [](const auto& info) {
      std::string name = info.param.scene + "_" + info.param.curve;
      std::replace(name.begin(), name.end(), '.', '_');
      return name;
    });

}  // namespace
}  // namespace cuboct
