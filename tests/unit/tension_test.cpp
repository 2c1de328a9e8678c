// SPDX-License-Identifier: MIT
// Figures of a tension test, on curves whose figures are known.
#include "model/analysis/tension.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cuboct::test {
namespace {

// Rises at 3 GPa to 60 MPa at 2 %, stays there to 20 %, falls to 0 within a tenth of a per cent; 1000
// readings.
struct Pull {
  std::vector<double> strain, stress;
};
Pull ideal(double end) {
  Pull test;
  for (int k = 0; k < 1000; ++k) {
    const double e = end * k / 999;
    test.strain.push_back(e);
    test.stress.push_back(e > 0.201 ? 0 : e > 0.2 ? 60e9 * (0.201 - e) : std::min(3e9 * e, 60e6));
  }
  return test;
}

TEST(TensionFigures, AreThoseOfTheCurve) {
  const Pull test = ideal(0.3);
  const TensionFigures figures = tension_figures(test.strain, test.stress);
  ASSERT_TRUE(figures.modulus && figures.strain_at_break);
  EXPECT_NEAR(*figures.modulus, 3e9, 1);
  EXPECT_NEAR(figures.strength, 60e6, 1);
  EXPECT_NEAR(figures.yield_strain, 0.02, 0.002);       // the mean of 11 readings rounds the knee off
  EXPECT_NEAR(*figures.strain_at_break, 0.201, 0.002);  // likewise
}

TEST(TensionFigures, RingingOfOnePeriodIsAveragedOut) {
  Pull test = ideal(0.3);
  for (size_t k = 0; k < test.stress.size(); ++k)
    test.stress[k] += 10e6 * std::sin(2 * M_PI * static_cast<double>(k) / 11);
  const TensionFigures figures = tension_figures(test.strain, test.stress);
  EXPECT_NEAR(figures.strength, 60e6, 0.2e6);
  ASSERT_TRUE(figures.strain_at_break);
  EXPECT_NEAR(*figures.strain_at_break, 0.201, 0.002);
}

TEST(TensionFigures, WhatIsNotThereIsNotTold) {
  const Pull whole = ideal(0.15);  // does not break
  EXPECT_FALSE(tension_figures(whole.strain, whole.stress).strain_at_break);
  const std::vector<double> coarse = {0, 0.01, 0.02, 0.03}, stress = {0, 30e6, 60e6, 60e6};
  EXPECT_FALSE(
      tension_figures(coarse, stress).modulus);  // two readings up to 0.5 % would be one line of many
  EXPECT_THROW(tension_figures({0}, {0}), std::invalid_argument);
  EXPECT_THROW(tension_figures({0, 1}, {0}), std::invalid_argument);
}

TEST(TensionFigures, ARunningMeanKeepsAStraightLine) {
  EXPECT_EQ(running_mean({1, 2, 3, 4, 5}, 3), (std::vector<double>{1, 2, 3, 4, 5}));
  EXPECT_EQ(running_mean({0, 3, 0, 3, 0}, 3), (std::vector<double>{0, 1, 2, 1, 0}));
}

}  // namespace
}  // namespace cuboct::test
