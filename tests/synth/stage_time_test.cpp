// SPDX-License-Identifier: MIT
// What is told of a synthesis' time, beside measured ones.
#include "synth/stage_time.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace cuboct::synth {
namespace {

// Bits of cells and seconds of docs/reference/synth.md, "Stages".
TEST(StageTime, MeasuredOnesLieInWhatIsTold) {
  struct Measured {
    Family family;
    uint64_t bits;
    double seconds;
  };
  for (const Measured& m : {Measured{Family::ice40, 374, 4},
                            {Family::ice40, 891, 7},
                            {Family::ice40, 35747, 65},
                            {Family::ecp5, 35747, 37},
                            {Family::xc7, 35747, 55},
                            {Family::ice40, 41176, 50},
                            {Family::ecp5, 41176, 53},
                            {Family::xc7, 41176, 53}}) {
    const std::string told = synthesis_time(m.family, m.bits);
    double low = 0, high = 0;
    ASSERT_EQ(std::sscanf(told.c_str(), "%lf to %lf s", &low, &high), 2) << told;
    EXPECT_LE(low, m.seconds) << told;
    EXPECT_GE(high, m.seconds) << told;
    EXPECT_LE(high, 5 * low) << told;
  }
  EXPECT_EQ(synthesis_time(Family::ecp5, 41176), "28 to 110 s");
  EXPECT_EQ(synthesis_time(Family::ecp5, 400000), "4 to 17 min");
}

}  // namespace
}  // namespace cuboct::synth
