// SPDX-License-Identifier: MIT
#include "model/trace/curve_readings.h"

#include <gtest/gtest.h>

namespace cuboct {
namespace {

std::vector<Curve> two() { return {{"grip.force", "N", {}, {}}, {"energy.total", "J", {}, {}}}; }

TEST(CurveReadings, AreTheRowsOfCurves) {
  std::vector<Curve> curves = two();
  std::vector<std::pair<uint64_t, std::vector<double>>> rows{{0, {1, 2}}, {3, {4}}, {6, {5}}, {9, {7, 8}}},
      seen;
  for (const auto& [step, values] : rows) add_reading(curves, step, values);
  EXPECT_EQ(curves[1].step, (std::vector<uint64_t>{0, 9}));
  for_each_reading(curves, [&](uint64_t step, Values values) {
    seen.emplace_back(step, std::vector<double>(values.begin(), values.end()));
  });
  EXPECT_EQ(seen, rows);
  EXPECT_EQ(curve_json(curves[1]),
            "{\"name\":\"energy.total\",\n\"unit\":\"J\",\n\"step\":[0,9],\n\"value\":[2,8]}");
  const std::vector<Curve> left = bare(curves);
  EXPECT_EQ(left[0].name + left[1].unit, "grip.forceJ");
  EXPECT_TRUE(left[0].step.empty() && left[1].value.empty());
}

// 4 to 8 and the newest, evenly spread, whatever their number.
TEST(CurveReadings, AreThinnedEvenly) {
  for (uint64_t count = 1; count < 400; ++count) {
    ThinnedReadings readings(4);
    for (uint64_t step = 0; step < count; ++step) {
      const std::vector<double> values{static_cast<double>(step) + 0.5, -1};
      readings.add(step, {values.data(), step % 16 == 0 ? 2U : 1U});
    }
    std::vector<Curve> curves = two();
    readings.append_to(curves);
    const std::vector<uint64_t>& steps = curves[0].step;
    ASSERT_EQ(steps.size(), readings.size());
    ASSERT_LE(steps.size(), 8U);
    ASSERT_GE(steps.size(), std::min<uint64_t>(count, 4));
    ASSERT_EQ(steps.front(), 0U);
    ASSERT_EQ(steps.back(), count - 1);
    const uint64_t apart = steps.size() > 1 ? steps[1] : 1;
    for (size_t k = 0; k < steps.size(); ++k) {
      ASSERT_EQ(curves[0].value[k], static_cast<double>(steps[k]) + 0.5);
      if (k + 1 < steps.size()) {
        ASSERT_EQ(steps[k], k * apart) << count;
      }
    }
    ASSERT_EQ(curves[1].step[0], 0U);
    readings.clear();
    ASSERT_EQ(readings.size(), 0U);
  }
}

}  // namespace
}  // namespace cuboct
