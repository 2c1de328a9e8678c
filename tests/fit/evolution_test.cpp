// SPDX-License-Identifier: MIT
#include "study/law_fit/evolution.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace cuboct::fit {
namespace {

using Sample = std::vector<double>;

double bowl(const Sample& x) {
  double sum = 0;
  for (size_t k = 0; k < x.size(); ++k) sum += (k + 1) * (x[k] - 0.05 * k) * (x[k] - 0.05 * k);
  return sum;
}

double least_after(int generations, unsigned seed) {
  const Sample start(13, 0.5);
  Evolution evolution(start, bowl(start), 16, 0.3, seed);
  double least = bowl(start);
  for (int g = 0; g < generations; ++g) {
    std::vector<double> losses;
    const auto asked = evolution.ask();
    EXPECT_EQ(asked.size(), 16U);
    EXPECT_EQ(asked, evolution.ask());  // looks only
    for (const Sample& x : asked) losses.push_back(bowl(x));
    least = std::min(least, *std::ranges::min_element(losses));
    evolution.tell(losses);
  }
  return least;
}

TEST(Evolution, FindsTheMiddleOfABowlInTheSameStepsEachTime) {
  EXPECT_LT(least_after(100, 1), 1e-5);
  EXPECT_EQ(least_after(20, 1), least_after(20, 1));
  EXPECT_NE(least_after(20, 1), least_after(20, 2));
}

TEST(Evolution, TakesALossForEachSample) {
  Evolution evolution(Sample(3, 0.5), 1, 8, 0.1, 1);
  EXPECT_THROW(evolution.tell({1, 2}), std::logic_error);
}

}  // namespace
}  // namespace cuboct::fit
