// SPDX-License-Identifier: MIT
#include "cli/quantity_text.h"

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
}

}  // namespace
}  // namespace cuboct
