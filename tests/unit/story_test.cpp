// SPDX-License-Identifier: MIT
#include "model/analysis/story.h"

#include <gtest/gtest.h>

namespace cuboct {
namespace {

using Frames = std::vector<size_t>;

const std::vector<uint64_t> kSteps{0, 10, 20, 30, 40, 50, 60, 70, 80, 90};

Curve peak_at(uint64_t step) {
  Curve curve;
  for (uint64_t at = 0; at <= 90; ++at) {
    curve.step.push_back(at);
    curve.value.push_back(at == step ? 2 : 1);
  }
  return curve;
}

TEST(Story, WithoutEventsIsSpreadEvenly) {
  EXPECT_EQ(story_frames(kSteps, nullptr, {}), (Frames{0, 3, 6, 9}));
  EXPECT_EQ(story_frames({7}, nullptr, {}), Frames{0});
  EXPECT_EQ(story_frames({0, 5}, nullptr, {}), (Frames{0, 1}));
}

TEST(Story, HasTheFirstBrokenBondAndTheLargestStress) {
  const Curve peak = peak_at(42);
  EXPECT_EQ(story_frames(kSteps, &peak, {}), (Frames{0, 4, 5, 9}));
  EXPECT_EQ(story_frames(kSteps, &peak, 2), (Frames{0, 2, 4, 5, 9}));
  const Curve between = peak_at(45);  // as near to 40 as to 50
  EXPECT_EQ(story_frames(kSteps, &between, {}), (Frames{0, 4, 5, 9}));
  const Curve early = peak_at(0);  // a quarter of the nine frames behind it: two
  EXPECT_EQ(story_frames(kSteps, &early, {}), (Frames{0, 2, 3, 9}));
  const Curve end = peak_at(90);
  EXPECT_EQ(story_frames(kSteps, &end, 8), (Frames{0, 3, 8, 9}));
}

}  // namespace
}  // namespace cuboct
