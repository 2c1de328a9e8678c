// SPDX-License-Identifier: MIT
// Errors fall as theory says that they must, in each setting. A study that measured something else, or from
// an untrue truth, would show other slopes.
#include <gtest/gtest.h>

#include <cmath>

#include "model/base/error.h"
#include "study/sweep/measure_errors.h"
#include "tests/study/small_study.h"

namespace cuboct::study {
namespace {

// One study with its truth, and outcomes of its points in order.
struct Measured {
  explicit Measured(const std::string& text) {
    const test::SmallStudy files;
    study = read_study(files.study(text));
    truth = make_truth(study, 1);
    for (const Settings& settings : study.points)
      outcomes.push_back(measure_errors(study, truth, truth, settings));
  }
  Study study;
  Truth truth;
  std::vector<Outcome> outcomes;
};

// How fast `value` falls from point a to point b, by powers of 2 of the setting's ratio.
double order(double a, double b, double ratio = 2) { return std::log(a / b) / std::log(ratio); }

constexpr const char* kFigure = "[[figure]]\nkind = \"mean\"\ncurve = \"energy.potential\"\n";

// Fixed numbers so fine that the time step is all that is left: positions of 2^-28 cells, tables of degree 2.
constexpr const char* kFine =
    "arithmetic = \"fixed\"\nposition_frac = 28\nguard = 12\ndifference_frac = 22\nstrength_bits = 27\n"
    "table_shape = \"uniform\"\ndegree = 2\nindex_bits = 10\n";

TEST(Order, TrajectoryAndFigureFallWithTheSquareOfTheTimeStep) {
  const Measured m(std::string(kFigure) + "[truth]\ntolerance = 1e-6\nrungs = 8\n" +
                   "[[sweep]]\narithmetic = \"float64\"\nintegrator = [\"euler\", \"verlet\"]\n"
                   "dt_safety = [0.2, 0.1, 0.05]\n[[sweep]]\ndt_safety = [0.2, 0.1, 0.05]\n" +
                   kFine);
  ASSERT_EQ(m.outcomes.size(), 9U);
  for (size_t first : {0, 3, 6})
    for (size_t k = first; k < first + 2; ++k) {
      const Errors &coarse = m.outcomes[k].errors, &fine = m.outcomes[k + 1].errors;
      // Of the next order dt^4 is left about (dt omega)^2/12 = 1 % at the coarsest step; the tables of the
      // fixed points add less than 1 % of the error at the finest one.
      EXPECT_NEAR(order(coarse.trajectory, fine.trajectory), 2, 0.1) << k;
      EXPECT_NEAR(order(coarse.figures[0], fine.figures[0]), 2, 0.15) << k;
    }
  // Velocities start half a step back, so both integrators go through the same positions.
  for (size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(m.outcomes[k].errors.trajectory / m.outcomes[k + 3].errors.trajectory, 1, 1e-6) << k;
}

// The block above starts at rest in its forces; this one falls from the start, so that the half step back
// counts.
TEST(Order, ARunThatStartsUnderForceStartsHalfAStepBack) {
  const Measured m(
      "[change]\ngravity = \"[0, 0, -1e7] m/s^2\"\n[truth]\ntolerance = 1e-6\nrungs = 8\n"
      "[[sweep]]\narithmetic = \"float64\"\nintegrator = [\"euler\", \"verlet\"]\ndt_safety = [0.2, 0.1]\n");
  ASSERT_EQ(m.outcomes.size(), 4U);
  EXPECT_NEAR(order(m.outcomes[0].errors.trajectory, m.outcomes[1].errors.trajectory), 2, 0.1);
  for (size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(m.outcomes[k].errors.trajectory / m.outcomes[k + 2].errors.trajectory, 1, 1e-6) << k;
}

TEST(Order, ForceErrorFallsWithTheSquareOfATablesBins) {
  const Measured m(
      std::string("[truth]\nrungs = 2\n[[sweep]]\nposition_frac = 28\nguard = 12\ndifference_frac = 22\n"
                  "strength_bits = 27\ntable_shape = \"uniform\"\nindex_bits = [6, 7, 8, 9]\n"));
  ASSERT_EQ(m.outcomes.size(), 4U);
  for (size_t k = 0; k < 3; ++k) {
    // A degree-1 table's error is h^2/8 f''; where a few bins span a stretch of the law, the median still
    // feels where its knots lie: a fifth of an order.
    EXPECT_NEAR(order(m.outcomes[k].errors.force_median, m.outcomes[k + 1].errors.force_median), 2, 0.2) << k;
  }
}

TEST(Order, ForceErrorFallsWithTheTablesBits) {
  // Velocities of 34 fractional bits: with more, tables of 10 bits could not be shifted to them.
  const Measured m(std::string(
      "[truth]\nrungs = 2\n[[sweep]]\nposition_frac = 26\nguard = 8\ndifference_frac = 22\n"
      "table_shape = \"uniform\"\ndegree = 2\nindex_bits = 10\nstrength_bits = [10, 12, 14, 16]\n"));
  for (size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(order(m.outcomes[k].errors.force_median, m.outcomes[k + 1].errors.force_median, 4), 1, 0.2)
        << k;
}

TEST(Order, ForceErrorFallsWithTheBitsOfDifferences) {
  const Measured m(std::string(
      "[truth]\nrungs = 2\n[[sweep]]\nposition_frac = 28\nguard = 12\nstrength_bits = 27\n"
      "table_shape = \"uniform\"\ndegree = 2\nindex_bits = 10\ndifference_frac = [10, 12, 14, 16]\n"));
  for (size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(order(m.outcomes[k].errors.force_median, m.outcomes[k + 1].errors.force_median, 4), 1, 0.15)
        << k;
}

// Momentum of fixed points is exact; that of doubles is rounding.
TEST(Order, MomentumOfIntegersIsKeptToTheLastBit) {
  const Measured m("[truth]\nrungs = 2\n[[sweep]]\n[[sweep]]\narithmetic = \"float64\"\n");
  EXPECT_EQ(m.outcomes[0].errors.momentum, 0);
  EXPECT_LT(m.outcomes[1].errors.momentum, 1e-12);
  EXPECT_EQ(m.outcomes[1].errors.force_max, 0);
}

TEST(Outcomes, RefusedAndUnstablePointsAreRows) {
  const Measured m(
      "[truth]\nrungs = 2\n[[sweep]]\ncell_edge = \"0.6 mm\"\n[[sweep]]\ndifference_frac = 24\nposition_frac "
      "= 20\n"
      "[[sweep]]\nintegrator = \"verlet\"\n[[sweep]]\nsum_bits = 14\n");
  EXPECT_EQ(m.outcomes[0].status, Status::refused);
  EXPECT_TRUE(m.outcomes[0].why.ends_with(
      "cell_edge = 0.0006 m is shorter than the pair law's cutoff, 0.000707107 m"))
      << m.outcomes[0].why;
  EXPECT_EQ(m.outcomes[1].status, Status::refused);
  EXPECT_EQ(m.outcomes[2].status, Status::refused);
  EXPECT_EQ(m.outcomes[2].why, "fixed arithmetic knows the integrator 'euler' only");
  EXPECT_EQ(m.outcomes[3].status, Status::unstable);
  EXPECT_NE(m.outcomes[3].why.find("step "), std::string::npos) << m.outcomes[3].why;
}

TEST(Truth, ConvergesInSecondOrderAndKnowsItsOwnError) {
  const Measured m(std::string(kFigure) + "[truth]\ntolerance = 1e-5\n[[sweep]]\n");
  const auto& rungs = m.truth.rungs;
  ASSERT_GE(rungs.size(), 4U);
  EXPECT_TRUE(m.truth.converged);
  for (size_t k = 2; k < rungs.size(); ++k) {
    EXPECT_NEAR(order(rungs[k - 1].trajectory, rungs[k].trajectory), 2, 0.1);
    EXPECT_NEAR(order(rungs[k - 1].change, rungs[k].change), 2, 0.15);
  }
  EXPECT_LT(rungs.back().trajectory, 1e-5);
  // The rung that would follow is a quarter as far, and the rest of the series a third of the last change.
  EXPECT_NEAR(m.truth.floor / rungs.back().trajectory, 1.0 / 3, 0.02);
  ASSERT_EQ(m.truth.notes.size(), 1U);
  EXPECT_EQ(m.truth.notes[0], "the cutoff is a part of this law: it is not lengthened");
}

// Half of the kinetic energy goes into bonds at once: of 17 samples, or 9, one is the start with all of it.
TEST(Truth, SaysThatSamplesDecideAFigure) {
  const Measured m(
      "[truth]\nrungs = 2\n[[figure]]\nkind = \"mean\"\ncurve = \"energy.kinetic\"\n[[sweep]]\n");
  ASSERT_EQ(m.truth.notes.size(), 3U);
  EXPECT_TRUE(m.truth.notes[0].starts_with("mean changes by ")) << m.truth.notes[0];
  EXPECT_TRUE(m.truth.notes[1].starts_with("the truth has not converged")) << m.truth.notes[1];
}

// A study whose figure is not there has no error in any point.
TEST(Truth, RefusesAFigureThatItDoesNotHold) {
  const auto refusal = [](const std::string& figure) -> std::string {
    try {
      const Measured m("[truth]\nrungs = 2\n[[figure]]\n" + figure + "[[sweep]]\n");
      return "none";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const std::string window =
      refusal("kind = \"mean\"\ncurve = \"energy.kinetic\"\nfrom = \"1 s\"\nto = \"2 s\"\n");
  EXPECT_NE(window.find("the run in doubles does not hold a figure: mean: 0 samples of the times of "
                        "energy.kinetic between 1 and 2, of 17 from 0 to "),
            std::string::npos)
      << window;
  EXPECT_NE(window.find("\n  hint: another window, or a longer run"), std::string::npos) << window;
}

// A row of particles, 1.1 apart: each lengthening of the cutoff takes in more of them, the last one by 1e-8
// of the energy. They hardly move meanwhile, so in time steps the run converges.
TEST(Truth, SaysThatTheLongestCutoffStillMatters) {
  const test::SmallStudy files;
  std::ofstream scene(files.path("block.toml"));
  scene << R"(units = "reduced"
mass = 1.0
[law]
kind = "lj"
epsilon = 1.0
sigma = 1.0
cutoff = 1.8
[run]
dt = 1e-5
steps = 1
)";
  for (int k = 0; k < 26; ++k) scene << "[[particle]]\nposition = [" << 1.1 * k << ", 0.0, 0.0]\n";
  scene.close();
  std::ofstream(files.path("row.toml")) << R"(scene = "block.toml"
samples = 1
[truth]
tolerance = 1e-9
[[figure]]
kind = "final"
curve = "energy.potential"
[[sweep]]
)";
  const Truth truth = make_truth(read_study(files.path("row.toml")), 1);
  ASSERT_EQ(truth.rungs.size(), 3U + 12U);
  EXPECT_FALSE(truth.converged);
  ASSERT_EQ(truth.notes.size(), 1U);
  // 1.8 * 1.25^12
  EXPECT_TRUE(truth.notes[0].starts_with("the cutoff was lengthened up to 26.19 m, where figures still "))
      << truth.notes[0];
}

}  // namespace
}  // namespace cuboct::study
