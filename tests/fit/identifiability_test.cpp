// SPDX-License-Identifier: MIT
#include "study/law_fit/identifiability.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cuboct::fit {
namespace {

// In the middle of three strains alone, where weights are 1: the target's norm is 2.
TEST(Identifiability, NamesWhatTheCurveDoesNotSee) {
  const std::vector<double> target{0, 2, 0};
  // The first two move the curve alike; the third does so along another strain, where the weight is 1/2.
  const Identifiability told = identifiability({{0, 1, 0}, {0, 1, 0}, {0, 0, 8}}, target, 0.01);
  ASSERT_EQ(told.combinations.size(), 3U);
  EXPECT_NEAR(told.combinations[0].change, 8 * std::sqrt(0.5) / 2, 1e-12);
  EXPECT_NEAR(told.combinations[0].weights[2], 1, 1e-12);
  EXPECT_NEAR(told.combinations[1].change, std::sqrt(2.0) / 2, 1e-12);
  EXPECT_NEAR(told.combinations[1].weights[0], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(told.combinations[1].weights[1], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(told.combinations[2].change, 0, 1e-12);
  EXPECT_NEAR(told.combinations[2].weights[0] + told.combinations[2].weights[1], 0, 1e-12);
  EXPECT_NEAR(told.uncertainty[2], 0.01 / (8 * std::sqrt(0.5) / 2), 1e-9);
  for (const size_t k : {0, 1})  // 0.01/(sqrt(2)/2) of their sum, and one width of their difference
    EXPECT_NEAR(told.uncertainty[k], std::sqrt(0.5 + 0.5 * 2e-4), 1e-9);
}

}  // namespace
}  // namespace cuboct::fit
