// SPDX-License-Identifier: MIT
#include "study/law_fit/curve_error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cuboct::fit {
namespace {

using Numbers = std::vector<double>;

TEST(CurveError, IsTheDistanceOverTheNorm) {
  const Numbers target{2, 2, 2};
  EXPECT_EQ(curve_error(target, target), 0);
  EXPECT_NEAR(curve_error({2.2, 2.2, 2.2}, target), 0.1, 1e-15);
  EXPECT_EQ(curve_error({0, 0, 0}, target), 1);
  // The ends weigh half: sqrt((1/2 2^2)/(2 2^2)).
  EXPECT_DOUBLE_EQ(curve_error({4, 2, 2}, target), 0.5);
  // sin against cos over a quarter: both have the norm sqrt(pi/4), their product the integral 1/2.
  const Numbers strains = even_strains(M_PI / 2, 2001);
  Numbers sine, cosine;
  for (const double s : strains) sine.push_back(std::sin(s)), cosine.push_back(std::cos(s));
  EXPECT_NEAR(curve_error(sine, cosine), std::sqrt((M_PI / 2 - 1) / (M_PI / 4)), 1e-6);
}

TEST(FirstPassage, TakesTheReadingsThatFirstComeToAStrain) {
  const Numbers strain{0, 1, 0.5, 2, 1.5}, stress{0, 1, 5, 2, 9};
  EXPECT_EQ(first_passage(strain, stress, {0, 0.5, 1, 1.25, 2}), (Numbers{0, 0.5, 1, 3.5, 2}));
}

TEST(FirstPassage, IsWithoutStressBeyondTheReadings) {
  EXPECT_EQ(first_passage({0, 1}, {0, 4}, {0, 1, 2, 3}), (Numbers{0, 4, 0, 0}));
  EXPECT_EQ(first_passage({}, {}, {0, 1}), (Numbers{0, 0}));
  // The last one, if it is nearly reached.
  EXPECT_EQ(first_passage({0, 0.99}, {0, 4}, {0, 0.5, 1}).back(), 4);
  EXPECT_EQ(first_passage({0, 0.7}, {0, 4}, {0, 0.5, 1}).back(), 0);
}

}  // namespace
}  // namespace cuboct::fit
