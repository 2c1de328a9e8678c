// SPDX-License-Identifier: MIT
#include "model/base/quantity_text.h"

#include <gtest/gtest.h>

namespace cuboct {
namespace {

TEST(QuantityText, TakesTheMultipleThatPeopleUse) {
  EXPECT_EQ(quantity_text(3.2e-3, "m"), "3.2 mm");
  EXPECT_EQ(quantity_text(-1.5e-5, "m"), "-15 um");
  EXPECT_EQ(quantity_text(1459, "m/s"), "1.46 km/s");
  EXPECT_EQ(quantity_text(0.9996, "s"), "1 s");  // not 1000 ms
  EXPECT_EQ(quantity_text(999.4e-9, "s"), "999 ns");
  EXPECT_EQ(quantity_text(1e-3, "s"), "1 ms");
  EXPECT_EQ(quantity_text(0, "J"), "0 J");
  EXPECT_EQ(quantity_text(2.5e-20, "J"), "2.5e-20 J");
  EXPECT_EQ(quantity_text(2e15, "Pa"), "2e+15 Pa");
  EXPECT_EQ(quantity_text(0.01234, ""), "0.0123");
}

TEST(QuantityText, CountsWithoutExponents) {
  EXPECT_EQ(count_text(12345), "12345");
  EXPECT_EQ(count_text(45.34e6), "45.3 million");
  EXPECT_EQ(count_text(12.34e9), "12.34 billion");
  EXPECT_EQ(times_text(14.23), "14.2");
  EXPECT_EQ(times_text(1234.5), "1234");
  EXPECT_EQ(times_text(2.5e6), "2.5 million");
}

TEST(QuantityText, EstimatesWaiting) {
  EXPECT_EQ(waiting_text(0.05), "under 0.1 s");
  EXPECT_EQ(waiting_text(34.6), "about 35 s");
  EXPECT_EQ(waiting_text(700), "about 12 min");
  EXPECT_EQ(waiting_text(3 * 3600), "about 3 h");
}

}  // namespace
}  // namespace cuboct
