// SPDX-License-Identifier: MIT
// Points of the gpu engine, computed on the host by its program: what stands beside this test is
// tests/gpu/cuboct-gpu-host. They have the errors that their arithmetic has in the other engines.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "study/sweep/gpu_program.h"
#include "study/sweep/measure_errors.h"
#include "study/sweep/measure_speed.h"
#include "tests/study/small_study.h"
#include "tests/support/refused_with.h"

namespace cuboct::study {
namespace {

// The block falls from the start: where an engine did not start half a step back, it would show. Its figure
// is a curve that the program reads.
constexpr const char* kFalling =
    "[change]\ngravity = \"[0, 0, -1e7] m/s^2\"\n[truth]\nrungs = 4\n"
    "[[figure]]\nkind = \"mean\"\ncurve = \"energy.potential\"\n";

struct Measured {
  explicit Measured(const std::string& text, const std::string& scene = "block.toml") {
    study = read_study(files.study(text, "study.toml", scene));
    truth = make_truth(study, 1);
    for (const Settings& settings : study.points)
      outcomes.push_back(measure_errors(study, truth, truth, settings));
  }
  test::SmallStudy files;
  Study study;
  Truth truth;
  std::vector<Outcome> outcomes;
};

TEST(GpuPoints, FixedOnesHaveTheBitsOfTheLatticesPoints) {
  const Measured m(
      std::string(kFalling) +
      "[[sweep]]\nengine = [\"lattice\", \"gpu\"]\ndt_safety = [0.1, 0.4]\nindex_bits = [5, 8]\n");
  ASSERT_EQ(m.outcomes.size(), 8U);
  for (size_t k = 0; k < 4; ++k) {
    const Outcome &lattice = m.outcomes[k], &gpu = m.outcomes[k + 4];
    EXPECT_EQ(gpu.settings.engine, "gpu");
    EXPECT_EQ(gpu.status, Status::done) << gpu.why;
    EXPECT_EQ(gpu.why, "");
    EXPECT_EQ(gpu.dt, lattice.dt);
    EXPECT_EQ(gpu.steps, lattice.steps);
    EXPECT_EQ(gpu.cost, lattice.cost);
    EXPECT_EQ(gpu.table_bits, lattice.table_bits);
    EXPECT_GT(gpu.errors.trajectory, 0);
    EXPECT_EQ(gpu.errors.trajectory, lattice.errors.trajectory);
    EXPECT_EQ(gpu.errors.force_median, lattice.errors.force_median);
    EXPECT_EQ(gpu.errors.force_max, lattice.errors.force_max);
    // Sums of curves are done in another order.
    EXPECT_NEAR(gpu.errors.values[0] / lattice.errors.values[0], 1, 1e-11);
    EXPECT_NEAR(gpu.errors.drift_per_step / lattice.errors.drift_per_step, 1, 1e-5);
  }
}

TEST(GpuPoints, RealOnesStartWhereTheReferenceDoes) {
  const Measured m(
      std::string(kFalling) +
      "[[sweep]]\nengine = \"gpu\"\narithmetic = [\"float64\", \"float32\"]\ndt_safety = [0.4, 0.2]\n"
      "[[sweep]]\narithmetic = \"float64\"\ndt_safety = [0.4, 0.2]\n");
  ASSERT_EQ(m.outcomes.size(), 6U);
  for (size_t k = 0; k < 2; ++k) {
    const Outcome &in_doubles = m.outcomes[k], &in_floats = m.outcomes[k + 2], &reference = m.outcomes[k + 4];
    ASSERT_EQ(reference.settings.engine, "reference");
    EXPECT_NEAR(in_doubles.errors.trajectory / reference.errors.trajectory, 1, 1e-6);
    EXPECT_NEAR(in_doubles.errors.values[0] / reference.errors.values[0], 1, 1e-9);
    EXPECT_NEAR(in_floats.errors.trajectory / reference.errors.trajectory, 1, 0.05);
    // Forces are the engine's own: doubles' rounding, and floats'.
    EXPECT_LT(in_doubles.errors.force_max, 1e-9);
    EXPECT_GT(in_floats.errors.force_median, 1e-9);
    EXPECT_LT(in_floats.errors.force_median, 1e-4);
    EXPECT_EQ(in_floats.steps, reference.steps);
    EXPECT_EQ(in_floats.halo_bits, 0);
  }
  // Of second order in dt, as the half step back makes it.
  EXPECT_NEAR(std::log2(m.outcomes[0].errors.trajectory / m.outcomes[1].errors.trajectory), 2, 0.1);
}

// Without gravity momentum is kept: to the last bit by integers, by floats to their rounding.
TEST(GpuPoints, MomentumIsThatOfTheWholeRun) {
  const Measured m(
      "[truth]\nrungs = 2\n[[sweep]]\nengine = \"gpu\"\narithmetic = [\"fixed\", \"float32\"]\n");
  EXPECT_EQ(m.outcomes[0].errors.momentum, 0);
  EXPECT_GT(m.outcomes[1].errors.momentum, 0);
  EXPECT_LT(m.outcomes[1].errors.momentum, 1e-4);
}

TEST(GpuPoints, RunsThatStopAreUnstableWithTheirReason) {
  const Measured m(
      "[truth]\nrungs = 2\n[[sweep]]\nsum_bits = 14\n[[sweep]]\nengine = \"gpu\"\nsum_bits = 14\n"
      "[[sweep]]\nengine = \"gpu\"\ncell_edge = \"0.6 mm\"\n");
  EXPECT_EQ(m.outcomes[1].status, Status::unstable);
  EXPECT_EQ(m.outcomes[1].why, m.outcomes[0].why);
  EXPECT_EQ(m.outcomes[1].steps, m.outcomes[0].steps);
  EXPECT_EQ(m.outcomes[2].status, Status::refused);
  EXPECT_TRUE(m.outcomes[2].why.ends_with(
      "cell_edge = 0.0006 m is shorter than the pair law's cutoff, 0.000707107 m"))
      << m.outcomes[2].why;
  EXPECT_TRUE(std::isnan(measure_speed(m.study, m.study.points[1]).particle_steps));
  EXPECT_TRUE(std::isnan(measure_speed(m.study, m.study.points[2]).particle_steps));
}

TEST(GpuPoints, SpeedIsOfStepsOverTheStudysSeconds) {
  const test::SmallStudy files;
  const Study study = read_study(files.study(
      "[speed]\nrepeats = 2\nseconds = 0.1\n[[sweep]]\nengine = \"gpu\"\narithmetic = \"float64\"\n"));
  const auto begin = std::chrono::steady_clock::now();
  const Speed speed = measure_speed(study, study.points[0]);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GE(seconds, 3 * 0.1);  // one repeat more goes first
  EXPECT_EQ(speed.repeats, 2);
  EXPECT_GE(speed.spread, 0);
  const Case c = resolve(study.base, study.points[0]);
  const auto particles = static_cast<double>(c.scene.body.size());
  EXPECT_NEAR(speed.simulated_seconds / speed.particle_steps * particles / study.grid.fitted(c.scene.rule.dt),
              1, 1e-12);
  // All steps that the window can have held took no longer than the whole of it.
  EXPECT_GT(speed.particle_steps, 160 * particles / seconds);
}

// What the program is told is the study's scene to the last bit of dt: otherwise it would make another plan.
TEST(GpuPoints, ThePlanIsThatOfTheStudy) {
  const Measured m("[truth]\nrungs = 2\n[[sweep]]\nengine = \"gpu\"\ndt_safety = [0.333, 0.1]\n");
  for (const Outcome& outcome : m.outcomes) EXPECT_EQ(outcome.status, Status::done) << outcome.why;
}

// A rule of text is a file beside the scene, of which the program reads a changed copy.
TEST(GpuPoints, RulesOfTextAreThoseOfTheOtherEngines) {
  const Measured m(
      "[truth]\nrungs = 3\n[[figure]]\nkind = \"final\"\ncurve = \"left.T\"\n"
      "[[sweep]]\nengine = [\"lattice\", \"gpu\"]\ndt_safety = [0.4, 0.1]\n"
      "[[sweep]]\narithmetic = \"float64\"\n"
      "[[sweep]]\nengine = \"gpu\"\narithmetic = [\"float64\", \"float32\"]\n",
      "warm.toml");
  ASSERT_EQ(m.outcomes.size(), 7U);
  for (const Outcome& outcome : m.outcomes) EXPECT_EQ(outcome.status, Status::done) << outcome.why;
  for (size_t k = 0; k < 2; ++k) {
    const Outcome &lattice = m.outcomes[k], &gpu = m.outcomes[k + 2];
    EXPECT_GT(gpu.errors.trajectory, 0);
    EXPECT_EQ(gpu.errors.trajectory, lattice.errors.trajectory);
    EXPECT_EQ(gpu.errors.values, lattice.errors.values);
    EXPECT_TRUE(std::isnan(gpu.errors.force_max));
  }
  const Outcome &reference = m.outcomes[4], &in_doubles = m.outcomes[5], &in_floats = m.outcomes[6];
  EXPECT_NEAR(in_doubles.errors.trajectory / reference.errors.trajectory, 1, 1e-6);
  EXPECT_NEAR(in_doubles.errors.values[0] / reference.errors.values[0], 1, 1e-12);
  EXPECT_LT(in_doubles.errors.force_max, 1e-9);
  EXPECT_GT(in_floats.errors.force_median, 1e-9);
  EXPECT_LT(in_floats.errors.force_median, 1e-3);
  EXPECT_GT(measure_speed(m.study, m.study.points[2]).particle_steps, 0);
  EXPECT_GT(measure_speed(m.study, m.study.points[5]).particle_steps, 0);
}

// Those that are no text are the reference's alone.
TEST(GpuPoints, OtherRulesOfRoundsAreRefused) {
  Settings settings;
  settings.engine = "gpu";
  const Base base = read_base(CUBOCT_SOURCE_DIR "/tests/gpu/lps/cracked_glass.toml", "");
  const std::string error = refused_with([&] { resolve(base, settings); });
  EXPECT_NE(error.find("and the gpu engine knows the pair law alone"), std::string::npos) << error;
}

TEST(GpuPoints, TheProgramTellsItsDevice) {
  std::string why;
  EXPECT_EQ(find_gpu(why), "host");
  EXPECT_EQ(why, "");
}

}  // namespace
}  // namespace cuboct::study
