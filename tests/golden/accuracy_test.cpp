// SPDX-License-Identifier: MIT
// Twelve scenes of different kinds and speeds, none with an arch file: what the fixed rule's probes say
// beside those of doubles, of the same integrator and the same steps. With CUBOCT_VERBOSE set it prints the
// table of docs/measured/accuracy.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "emu/lattice/run.h"
#include "hw/engine/engine_kind.h"
#include "hw/engine/scene_engine.h"
#include "hw/plan/setup.h"

namespace cuboct {
namespace {

// How a curve counts. A run that is chaotic parts from any other in the end, so that only its means can
// agree.
enum class By : uint8_t { curve, mean };

struct Case {
  std::string scene;
  std::vector<std::string> curves;
  By by = By::curve;
};

// For the names of tests in messages.
void PrintTo(const Case& one, std::ostream* out) { *out << one.scene; }

std::vector<uint64_t> looks(const Scene& scene) {
  std::vector<uint64_t> at;
  for (uint64_t step = 0; step <= scene.steps; step += std::max<uint64_t>(1, scene.probe_every))
    at.push_back(step);
  if (at.back() != scene.steps) at.push_back(scene.steps);
  return at;
}

std::vector<Curve> in_doubles(const Scene& scene, const Plan& plan, const RunRequest& request) {
  return record(scene, scene_reference_kind(scene, plan, {}), request).trace.curves;
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

class Accuracy : public testing::TestWithParam<Case> {};

// One per cent: what docs/measured/accuracy.md promises of the widths that are taken where no arch file
// gives any.
TEST_P(Accuracy, IsThatOfDoublesToOnePerCent) {
  const Case& one = GetParam();
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/accuracy/" + one.scene + ".toml");
  const Plan plan = plan_of(scene, {});
  emu::LatticeRun request;
  request.steps = request.hash_every = scene.steps;
  request.energies = request.watch = true;
  request.engine.threads = 1;
  request.probes = looks(scene);
  const Recorded run = emu::run_lattice(scene, plan, request);
  ASSERT_FALSE(run.trace.stop) << run.trace.stop->text;
  for (const Finding& finding : run.trace.findings) ADD_FAILURE() << finding.text;

  const std::vector<Curve> reference = in_doubles(scene, plan, request);
  for (const std::string& name : one.curves) {
    const std::vector<double>&fixed = values(run.trace.curves, name), &doubles = values(reference, name);
    ASSERT_EQ(fixed.size(), doubles.size());
    std::vector<double> off;
    for (size_t k = 0; k < fixed.size(); ++k) off.push_back(fixed[k] - doubles[k]);
    const bool by_curve = one.by == By::curve;
    const double error =
        by_curve ? root_mean_square(off) / root_mean_square(doubles) : std::abs(mean(off) / mean(doubles));
    if (std::getenv("CUBOCT_VERBOSE")) {
      const Widths& w = plan.rule.widths;
      fmt::print("| `{}` | {}{} | {:.5g} | {:.5g} | {:.2g} | {}, {}, {}, {} |\n", one.scene,
                 by_curve ? "" : "mean of ", name, by_curve ? doubles.back() : mean(doubles),
                 by_curve ? fixed.back() : mean(fixed), error, w.position_frac, w.guard, w.difference_frac,
                 w.strength_bits);
    }
    EXPECT_LT(error, 0.01) << name;
    EXPECT_GT(root_mean_square(doubles), 0) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Accuracy,
                         testing::Values(Case{"slow_pull", {"middle.x", "grip.force_x"}},
                                         Case{"fast_pull", {"middle.x", "grip.force_x"}},
                                         Case{"cantilever", {"tip.z"}},
                                         Case{"drop", {"ball.z", "floor.force_z"}},
                                         Case{"lj_copper", {"energy.kinetic", "pressure"}, By::mean},
                                         Case{"sheet", {"pull.force_x", "notch.y"}},
                                         Case{"gas", {"energy.kinetic", "pressure"}, By::mean},
                                         Case{"creep", {"end.x", "grip.force_x"}},
                                         Case{"vibration", {"middle.z"}},
                                         Case{"impact_wave", {"wall.force_x", "middle.x"}},
                                         Case{"rotation", {"corner.x", "corner.y", "corner.z"}},
                                         Case{"two_materials", {"border.x", "grip.force_x"}}),
                         [](const auto& info) { return info.param.scene; });

}  // namespace
}  // namespace cuboct
