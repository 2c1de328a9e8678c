// SPDX-License-Identifier: MIT
#include "study/sweep/sensitivity.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cuboct::study {
namespace {

TEST(Sensitivity, OfExponentialGrowthIsItsTime) {
  std::vector<double> distance;
  for (int k = 0; k <= 400; ++k) distance.push_back(1e-9 * std::exp(0.0301 * k));
  const Sensitivity s = sensitivity_of(distance, 0.5);
  EXPECT_NEAR(s.lyapunov_time, 0.5 / 0.0301, 1e-9);
  EXPECT_EQ(s.horizon, 99U);  // the last sample before 3/0.0301 = 99.7
}

TEST(Sensitivity, OfGrowthInProportionToTimeIsNone) {
  std::vector<double> distance;
  for (int k = 0; k <= 400; ++k) distance.push_back(1e-9 * (1 + k));
  const Sensitivity s = sensitivity_of(distance, 0.5);
  EXPECT_TRUE(std::isinf(s.lyapunov_time));
  EXPECT_EQ(s.horizon, 19U);  // twentyfold: there the comparison ends, whatever the reason
}

TEST(Sensitivity, OfABoundDistanceIsNoneAndTheHorizonIsTheEnd) {
  std::vector<double> distance;
  for (int k = 0; k <= 400; ++k) distance.push_back(1e-9 * (1 + 0.5 * std::sin(k)));
  const Sensitivity s = sensitivity_of(distance, 0.5);
  EXPECT_TRUE(std::isinf(s.lyapunov_time));
  EXPECT_EQ(s.horizon, 400U);
}

TEST(Sensitivity, TheHorizonIsAtLeastOneSample) { EXPECT_EQ(sensitivity_of({1e-9, 1e-3}, 0.5).horizon, 1U); }

}  // namespace
}  // namespace cuboct::study
