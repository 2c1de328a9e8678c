// SPDX-License-Identifier: MIT
// The estimates of probes' errors beside what the lattice engine leaves of the curves of doubles, and formats
// that keep what a probe asks for.
#include "model/analysis/probe_error.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "emu/lattice/run.h"
#include "hw/engine/scene_engine.h"
#include "hw/plan/probe_accuracy.h"
#include "model/analysis/meter.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

// E = 3 GPa; the first grip's wave goes to and fro four times.
std::string bar(const std::string& probe = "", const std::string& run = "") {
  return R"(density = "1.41 g/cm^3"
[packing]
pitch = "0.5 mm"
axes = [[1, 1, 0], [-1, 1, 0]]
[geometry]
shape = "box"
size = "[12, 2, 2] mm"
[regions]
left = { shape = "half_space", point = "[-5, 0, 0] mm", normal = "x" }
right = { shape = "half_space", point = "[5, 0, 0] mm", normal = "-x" }
lower = { shape = "box", centre = "[-2.5, 0, 0] mm", size = "[0.6, 9, 9] mm" }
upper = { shape = "box", centre = "[2.5, 0, 0] mm", size = "[0.6, 9, 9] mm" }
[law]
kind = "elastic"
youngs_modulus = "3 GPa"
direction = "x"
[damping]
ratio = 0.2
[[constraint]]
name = "fixed"
kind = "held"
region = "left"
[[constraint]]
name = "pulled"
kind = "moved"
velocity = "[4, 0, 0] m/s"
region = "right"
[[probe]]
name = "tension"
kind = "stress_strain"
axis = "x"
lower = "lower"
upper = "upper"
grip = "right"
area = "4 mm^2"
)" + probe +
         R"(
[run]
dt_safety = 0.5
duration = "60 us"
)" + run;
}

// Bent by a sudden weight.
const std::string kBeam = R"(density = "1.2 g/cm^3"
gravity = "[0, 0, -9.81] m/s^2"
[packing]
pitch = "2 mm"
[geometry]
shape = "box"
size = "[60, 6, 6] mm"
[law]
kind = "elastic"
youngs_modulus = "20 MPa"
direction = "x"
[[constraint]]
name = "wall"
kind = "held"
region = { shape = "half_space", point = "[-25, 0, 0] mm", normal = "x" }
[[probe]]
name = "tip"
kind = "displacement"
region = { shape = "half_space", point = "[28, 0, 0] mm", normal = "-x" }
axis = "-z"
[run]
dt_safety = 0.5
duration = "10 ms"
)";

// A bar between a floor and a plate that comes slowly. It rings, and damping ends long waves late.
std::string pillar(const std::string& probe = "") {
  return R"(density = "2.5 g/cm^3"
gravity = "[0, 0, -9.81] m/s^2"
[packing]
pitch = "2 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[10, 10, 40] mm"
[law]
kind = "elastic"
youngs_modulus = "2 GPa"
direction = "z"
[damping]
ratio = 0.05
[regions]
top = { shape = "half_space", point = "[0, 0, 38.5] mm", normal = "-z" }
[[constraint]]
name = "floor"
kind = "held"
region = { shape = "half_space", point = "[0, 0, 1.5] mm", normal = "z" }
[[constraint]]
name = "plate"
kind = "moved"
velocity = "[0, 0, -0.1] m/s"
region = "top"
[[probe]]
name = "push"
kind = "force"
axis = "z"
region = "top"
)" + probe +
         "[run]\nduration = \"0.5 ms\"\n";
}

struct Compared {
  CurveError estimate;
  double measured = 0;
};

std::vector<double> curve_of(const std::vector<Curve>& curves, const std::string& name) {
  for (const Curve& curve : curves)
    if (curve.name == name) return curve.value;
  throw std::runtime_error("no curve " + name);
}

double off_by(const std::vector<double>& fixed, const std::vector<double>& doubles, bool means) {
  double off = 0, size = 0, sum = 0, sums = 0;
  for (size_t k = 0; k < fixed.size(); ++k) {
    off += std::pow(fixed[k] - doubles[k], 2), size += doubles[k] * doubles[k];
    sum += fixed[k], sums += doubles[k];
  }
  return means ? std::abs(sum / sums - 1) : std::sqrt(off / size);
}

// `curves`: of the first probe's estimates, in their order.
std::vector<Compared> compare(const Scene& scene, const std::vector<std::string>& curves) {
  const Plan plan = plan_of(scene, {});
  emu::LatticeRun request;
  request.steps = request.hash_every = scene.steps;
  request.engine.threads = 1;
  request.probes = probe_steps_of(scene, scene.steps);
  const Recorded run = emu::run_lattice(scene, plan, request);
  EXPECT_FALSE(run.trace.stop);
  const Recorded doubles = record(scene, scene_reference_kind(scene, plan, {}), request);
  const std::vector<ProbeError> errors = probe_errors(scene, plan);
  std::vector<Compared> compared;
  EXPECT_EQ(errors.front().curves.size(), curves.size());
  for (size_t k = 0; k < curves.size(); ++k)
    compared.push_back({errors.front().curves.at(k), off_by(curve_of(run.trace.curves, curves[k]),
                                                            curve_of(doubles.trace.curves, curves[k]),
                                                            errors.front().curves[k].of_means)});
  return compared;
}

// An estimate is not below what is measured, and at most ten times as much.
void expect_estimated(const std::vector<Compared>& compared) {
  for (const auto& [estimate, measured] : compared) {
    EXPECT_GE(estimate.error, measured) << estimate.quantity;
    EXPECT_LE(estimate.error, 10 * measured) << estimate.quantity;
  }
}

TEST(ProbeError, OfABarIsEstimated) {
  for (const char* run : {"accuracy = 1e-2", "", "accuracy = 1e-4"})
    expect_estimated(compare(parse_scene(bar("", run), "bar.toml"), {"tension.stress", "tension.strain"}));
}

TEST(ProbeError, OfABeamIsEstimated) {
  expect_estimated(compare(parse_scene(kBeam, "beam.toml"), {"tip.along"}));
}

TEST(ProbeError, OfAGasIsThatOfReadingsThatPart) {
  const Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/templates/gas.toml");
  const std::vector<ProbeError> errors = probe_errors(scene, plan_of(scene, {}));
  ASSERT_EQ(errors.front().curves.size(), 2U);
  EXPECT_FALSE(errors.front().curves[0].of_means);
  EXPECT_TRUE(errors.front().curves[1].of_means);
  // 1/sqrt(3 N) of 2048 particles.
  EXPECT_NEAR(errors.front().curves[0].error, 1 / std::sqrt(3 * 2048.0), 1e-12);
  EXPECT_LT(errors.front().curves[1].error, errors.front().curves[0].error);
  const std::vector<Compared> compared = compare(scene, {"gas.temperature", "gas.temperature"});
  for (const auto& [estimate, measured] : compared) EXPECT_GE(estimate.error, measured);
}

TEST(ProbeError, AskedOfAProbeChoosesFinerFormatsThatKeepIt) {
  const Scene plain = parse_scene(bar(), "bar.toml"),
              asking = parse_scene(bar("accuracy = 2e-4"), "bar.toml");
  const Plan before = plan_of(plain, {}), plan = plan_of(asking, {});
  EXPECT_GT(plan.rule.widths.strength_bits, before.rule.widths.strength_bits);
  EXPECT_GT(plan.rule.widths.difference_frac, before.rule.widths.difference_frac);
  EXPECT_GT(probe_errors(plain, before).front().curves.front().error, 2e-4);
  for (const auto& [estimate, measured] : compare(asking, {"tension.stress", "tension.strain"})) {
    EXPECT_LE(2 * estimate.error, 2e-4) << estimate.quantity;
    EXPECT_LE(measured, 2e-4) << estimate.quantity;
    EXPECT_GT(measured, 0) << estimate.quantity;
  }
  const auto reason = [&](const std::string& key) {
    return std::ranges::find_if(plan.reasons, [&](const WidthReason& r) { return r.key == key; })->why;
  };
  EXPECT_EQ(reason("strength_bits"), "by the accuracy of probe 'tension'");
  EXPECT_TRUE(reason("difference_frac").ends_with(", by the accuracy of probe 'tension'"))
      << reason("difference_frac");
}

// The estimate is too low there, by half at most, and what is asked for is kept all the same.
TEST(ProbeError, AskedOfABarThatRingsIsKept) {
  for (const auto& [estimate, measured] : compare(parse_scene(pillar(), "pillar.toml"), {"push.force"})) {
    EXPECT_LT(estimate.error, measured);
    EXPECT_GE(2 * estimate.error, 0.95 * measured);
    EXPECT_GT(measured, 0.005);
  }
  for (const auto& [estimate, measured] :
       compare(parse_scene(pillar("accuracy = 0.005\n"), "pillar.toml"), {"push.force"})) {
    EXPECT_LE(2 * estimate.error, 0.005);
    EXPECT_LE(measured, 0.005);
  }
}

// A bar of text that takes up water from its left end, and swells. Its bonds rub at millimetres per second,
// and part by 1e-7 of a cell in a step.
TEST(ProbeError, ATextsFrictionOfSlowBondsIsKept) {
  const auto swelling = [](const std::string& friction) {
    return parse_scene(R"x(density = "1200 kg/m^3"
[packing]
pitch = "1 mm"
[geometry]
shape = "box"
min = "[0, 0, 0] mm"
max = "[20, 3, 3] mm"
[regions]
left = { shape = "half_space", point = "[1, 0, 0] mm", normal = "x" }
[[probe]]
name = "end"
kind = "displacement"
region = { shape = "half_space", point = "[19, 0, 0] mm", normal = "-x" }
axis = "x"
[run]
duration = "2 ms"
[rule]
name = "moisture"
bonds = "reference"
reach = "1.2 * pitch"
stiffness = "8 * spring"
[rule.parameters]
spring = "20 kN/m"
diffusivity = "1e-3 m^2/s"
[rule.particle.w]
range = [0, 1]
start = "select(inside(left), 1, 0)"
[rule.particle.wet]
kind = "truth"
start = "inside(left)"
[rule.let]
rate = "diffusivity / (2 * pitch^2)"
rest = "r0 * (1 + 0.02 * (w_i + w_j) / 2)"
[[rule.round]]
sum.flow = "rate * (w_j - w_i)"
sum.force = "spring * (r - rest) / r * d)x" +
                           friction + R"x("
finish.w = "select(wet, w, w + dt * flow)"
)x",
                       "moisture.toml");
  };
  const Scene rubbing = swelling(" + 0.02 kg/s * dot(v_j - v_i, d) / r^2 * d");
  const Plan plan = scene_plan_of(rubbing, {}, "lattice", false);
  EXPECT_EQ(plan.rule.widths.relative_velocity_bits, 27);
  EXPECT_LT(scene_plan_of(swelling(""), {}, "lattice", false).rule.widths.relative_velocity_bits, 27);
  emu::LatticeRun request;
  request.steps = request.hash_every = rubbing.steps;
  request.engine.threads = 1;
  request.probes = probe_steps_of(rubbing, rubbing.steps);
  const Recorded run = emu::run_lattice(rubbing, plan, request);
  EXPECT_FALSE(run.trace.stop);
  const Recorded doubles = record(rubbing, scene_reference_kind(rubbing, plan, {}), request);
  const std::vector<double> end = curve_of(doubles.trace.curves, "end.along");
  EXPECT_GT(std::ranges::max(end), 1e-6);
  EXPECT_LT(off_by(curve_of(run.trace.curves, "end.along"), end, false), 0.003);
}

TEST(ProbeError, AnAccuracyThatIsKeptChangesNothing) {
  EXPECT_EQ(plan_of(parse_scene(bar("accuracy = 0.05"), "bar.toml"), {}).hash,
            plan_of(parse_scene(bar(), "bar.toml"), {}).hash);
}

TEST(ProbeError, RefusesWhatNoFormatsKeep) {
  const std::string best = refused_with([] { plan_of(parse_scene(bar("accuracy = 1e-6"), "bar.toml"), {}); });
  EXPECT_EQ(
      best,
      "bar.toml:36:12: the stress of probe 'tension' cannot be had within 1e-06: the best that formats do "
      "is about 4.4e-05\n  hint: accuracy = 4.5e-05, or doubles (--engine reference)");
  // Doubles run it.
  EXPECT_GT(scene_plan_of(parse_scene(bar("accuracy = 1e-6"), "bar.toml"), {}, "reference", true).particles,
            0U);
}

// A field that integers hold coarsely: unit times root of the steps, beside what the bar of a board leaves.
TEST(ProbeError, OfAResolutionIsThatOfRuns) {
  Scene scene = read_scene(CUBOCT_SOURCE_DIR "/scenes/boards/heat.toml");
  scene.probe_every = 10;
  const Plan plan = program_plan_of(scene, {});
  const ProbeError error = probe_errors(scene, plan).front();
  ASSERT_EQ(error.curves.size(), 1u);
  EXPECT_EQ(error.why, "the resolution of T");
  EXPECT_EQ(error.curves[0].unit, "K");
  EXPECT_NEAR(error.curves[0].error, 0.0625 * std::sqrt(200.0), 0.01);
  emu::LatticeRun request;
  request.steps = request.hash_every = scene.steps;
  request.engine.threads = 1;
  request.probes = probe_steps_of(scene, scene.steps);
  const std::vector<double> fixed = curve_of(emu::run_lattice(scene, plan, request).trace.curves, "left.T");
  const std::vector<double> doubles =
      curve_of(record(scene, scene_reference_kind(scene, plan, {}), request).trace.curves, "left.T");
  double squares = 0;
  for (size_t k = 0; k < fixed.size(); ++k) squares += std::pow(fixed[k] - doubles[k], 2);
  const double measured = std::sqrt(squares / static_cast<double>(fixed.size()));
  EXPECT_GT(measured, 0.1 * error.curves[0].error);
  EXPECT_LT(measured, error.curves[0].error);
}

// Nothing is read of a run without steps; a grip between the marks leaves no share of a length.
TEST(ProbeError, OfNoStepsIsNotEstimated) {
  Scene scene = parse_scene(bar(), "bar.toml");
  scene.steps = 0;
  const ProbeError error = probe_errors(scene, plan_of(scene, {})).front();
  EXPECT_TRUE(error.curves.empty());
  EXPECT_EQ(error.why, "the run has no steps");
}

TEST(ProbeError, RefusesWhatItDoesNotEstimate) {
  const std::string held = R"(
[[probe]]
name = "grip"
kind = "displacement"
region = "left"
accuracy = 0.001
)";
  EXPECT_EQ(refused_with([&] { plan_of(parse_scene(bar(held), "bar.toml"), {}); }),
            "bar.toml:41:12: no accuracy can be asked of probe 'grip': its particles are held");
  const std::string crack = R"(
[[probe]]
name = "crack"
kind = "crack"
region = "left"
axis = "x"
accuracy = 0.001
)";
  EXPECT_EQ(refused_with([&] { parse_scene(bar(crack), "bar.toml"); }),
            "bar.toml:42:12: a crack goes on by a spacing at a time: no accuracy is asked of it");
}

}  // namespace
}  // namespace cuboct
