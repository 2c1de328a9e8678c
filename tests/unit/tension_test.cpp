// SPDX-License-Identifier: MIT
// Figures of a tension test, on curves whose figures are known.
#include "model/analysis/tension.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace cuboct::test {
namespace {

constexpr double kModulus = 3e9;

// `count` readings at equal times, strains up to `end`.
template <typename Stress>
TensionTest test_of(double end, size_t count, const Stress& stress) {
  TensionTest test;
  for (size_t k = 0; k < count; ++k) {
    test.time.push_back(static_cast<double>(k));
    test.strain.push_back(end * static_cast<double>(k) / static_cast<double>(count - 1));
    test.stress.push_back(stress(test.strain.back()));
  }
  return test;
}

// Rises at 3 GPa to 60 MPa at 2 %, stays there to 20 %, falls to 0 within a tenth of a per cent.
TensionTest ideal(double end) {
  return test_of(end, 1000, [](double e) {
    return e > 0.201 ? 0 : e > 0.2 ? 60e9 * (0.201 - e) : std::min(kModulus * e, 60e6);
  });
}

// A bar whose one end moves from time 0 on: waves go to and fro, `trips` times till the end, and each adds as
// much to the stress there. By d'Alembert the stress is density c v (1 + 2 n) after n round trips, which is
// the modulus times the strain at the middle of each.
TensionTest struck(double end, double trips) {
  constexpr size_t kCount = 500;
  TensionTest test = test_of(end, kCount, [](double) { return 0.0; });
  test.round_trip = kCount / trips;
  for (size_t k = 0; k < kCount; ++k)
    test.stress[k] = kModulus * end / trips * (0.5 + std::floor(test.time[k] / test.round_trip));
  return test;
}

TEST(TensionFigures, AreThoseOfTheCurve) {
  const TensionFigures figures = tension_figures(ideal(0.3));
  ASSERT_TRUE(figures.modulus.value && figures.strength.value && figures.yield_strain.value &&
              figures.strain_at_break.value);
  EXPECT_NEAR(*figures.modulus.value, kModulus, 0.01 * kModulus);
  EXPECT_EQ(figures.modulus.from, 0);
  EXPECT_NEAR(figures.modulus.to, 0.02, 0.002);
  EXPECT_NEAR(*figures.strength.value, 60e6, 1);
  EXPECT_FALSE(figures.rises_at_end);
  EXPECT_NEAR(*figures.yield_strain.value, 0.02, 0.002);      // the mean of 11 readings rounds the knee off
  EXPECT_NEAR(*figures.strain_at_break.value, 0.201, 0.002);  // likewise
}

TEST(TensionFigures, RingingOfOnePeriodIsAveragedOut) {
  TensionTest test = ideal(0.3);
  for (size_t k = 0; k < test.stress.size(); ++k)
    test.stress[k] += 10e6 * std::sin(2 * M_PI * static_cast<double>(k) / 11);
  const TensionFigures figures = tension_figures(test);
  ASSERT_TRUE(figures.strength.value && figures.strain_at_break.value);
  EXPECT_NEAR(*figures.strength.value, 60e6, 0.2e6);
  EXPECT_NEAR(*figures.strain_at_break.value, 0.201, 0.002);
}

// The steps that waves make are no slope: a line through those of the start is off by far.
TEST(TensionFigures, WavesDoNotMakeTheModulus) {
  const TensionTest test = struck(0.04, 8);
  double xy = 0, xx = 0;
  for (size_t k = 0; test.strain[k] < 0.005; ++k)
    xy += (test.strain[k] - 0.0025) * test.stress[k], xx += std::pow(test.strain[k] - 0.0025, 2);
  EXPECT_LT(xy / xx, 0.1 * kModulus);
  const CurveFigure modulus = tension_figures(test).modulus;
  ASSERT_TRUE(modulus.value);
  EXPECT_NEAR(*modulus.value, kModulus, 0.01 * kModulus);
  EXPECT_NEAR(modulus.from, 0.005, 1e-4);  // behind one of eight round trips
  EXPECT_NEAR(modulus.to, 0.035, 5e-4);    // where the last one begins
  EXPECT_LT(modulus.error, 0.01 * kModulus);
  EXPECT_EQ(tension_figures(test).yield_strain.why, "the stress still rises at the end");
}

// f = E (e - e^3/(3 h^2)), the pair laws' own. Its slope falls by (e/h)^2; the halves of a line up to w
// differ by 2 % or less up to w^2/(2 h^2) = 2 %, and the line's slope is then 1.2 % less than the first.
TEST(TensionFigures, TheModulusEndsWhereTheCurveBends) {
  constexpr double kPeak = 0.09;
  const TensionTest test =
      test_of(0.08, 800, [](double e) { return kModulus * (e - e * e * e / (3 * kPeak * kPeak)); });
  const CurveFigure modulus = tension_figures(test).modulus;
  ASSERT_TRUE(modulus.value);
  EXPECT_NEAR(modulus.to, kPeak * std::sqrt(0.04), 0.003);
  EXPECT_NEAR(*modulus.value, (1 - 0.3 * 0.04) * kModulus, 0.005 * kModulus);
}

// Scatter of one in a hundred, a plain sequence: the error tells it.
TEST(TensionFigures, TheErrorIsThatOfTheScatter) {
  constexpr size_t kCount = 200;
  constexpr double kEnd = 0.02, kScatter = 0.6e6;
  double off = 0, told = 0;
  constexpr int kDraws = 40;
  uint64_t dice = 7;
  for (int draw = 0; draw < kDraws; ++draw) {
    TensionTest test = test_of(kEnd, kCount, [&](double e) {
      double sum = 0;  // of twelve even draws: a variance of one
      for (int k = 0; k < 12; ++k) {
        dice = dice * 6364136223846793005u + 1442695040888963407u;
        sum += static_cast<double>(dice >> 11) * 0x1p-53;
      }
      return kModulus * e + kScatter * (sum - 6);
    });
    const CurveFigure modulus = tension_figures(test).modulus;
    ASSERT_TRUE(modulus.value) << modulus.why;
    off += std::pow(*modulus.value - kModulus, 2) / kDraws;
    told += std::pow(modulus.error, 2) / kDraws;
  }
  EXPECT_NEAR(std::sqrt(off / told), 1, 0.35);
}

TEST(TensionFigures, WhatIsNotThereIsNotTold) {
  const auto why = [](const CurveFigure& figure) { return figure.value ? "is there" : figure.why; };
  const TensionFigures whole = tension_figures(ideal(0.15));  // does not break
  EXPECT_EQ(why(whole.strain_at_break), "at the end it carries 100 % of its strength");
  EXPECT_TRUE(whole.yield_strain.value);

  const TensionFigures early = tension_figures(ideal(0.015));
  EXPECT_EQ(why(early.yield_strain), "the stress still rises at the end");
  EXPECT_TRUE(early.rises_at_end);
  EXPECT_NEAR(*early.strength.value, kModulus * 0.015, 0.02 * kModulus * 0.015);

  // A brittle bar, which breaks while its curve is a line.
  const TensionFigures brittle =
      tension_figures(test_of(0.02, 1000, [](double e) { return e < 0.01 ? kModulus * e : 0; }));
  EXPECT_EQ(why(brittle.yield_strain), "it breaks on its straight part");
  ASSERT_TRUE(brittle.strain_at_break.value);
  EXPECT_NEAR(*brittle.strain_at_break.value, 0.01, 2e-4);

  const TensionTest coarse = test_of(0.03, 4, [](double e) { return std::min(kModulus * e, 60e6); });
  EXPECT_EQ(why(tension_figures(coarse).modulus), "3 readings before the largest stress: 4 are needed");
  EXPECT_EQ(why(tension_figures(struck(0.01, 3)).modulus),
            "2 round trips of waves behind the first one and before the largest stress: 3 are needed");
  EXPECT_EQ(why(tension_figures(test_of(0.02, 40, [](double e) { return 1e12 * e * e; })).modulus),
            "the stress is no straight line of the strain from 0 to 0.00154");

  // Grips that outrun the waves: one push at the start, and nothing behind it.
  TensionTest torn = struck(0.5, 2);
  for (size_t k = 0; k < torn.stress.size(); ++k) torn.stress[k] = k < 20 ? 1e9 : 0;
  const TensionFigures figures = tension_figures(torn);
  for (const CurveFigure* figure : {&figures.strength, &figures.yield_strain, &figures.strain_at_break})
    EXPECT_EQ(why(*figure), "the largest stress comes while waves go to and fro for the first time");
  EXPECT_FALSE(figures.modulus.value);

  EXPECT_THROW(tension_figures({{0}, {0}, {0}}), std::invalid_argument);
  EXPECT_THROW(tension_figures({{0, 1}, {0}, {0, 1}}), std::invalid_argument);
  EXPECT_THROW(tension_figures({{0, 1}, {0, 1}, {1, 1}}), std::invalid_argument);
}

// The same curve pressed: signs alone differ.
TEST(TensionFigures, PressingIsPullingTheOtherWay) {
  const TensionTest pulled = ideal(0.3);
  TensionTest pressed = pulled;
  for (double& e : pressed.strain) e = -e;
  for (double& s : pressed.stress) s = -s;
  const TensionFigures a = tension_figures(pulled), b = tension_figures(pressed);
  EXPECT_EQ(*a.modulus.value, *b.modulus.value);
  EXPECT_EQ(a.modulus.to, -b.modulus.to);
  EXPECT_EQ(*a.strength.value, -*b.strength.value);
  EXPECT_EQ(*a.yield_strain.value, -*b.yield_strain.value);
  EXPECT_EQ(*a.strain_at_break.value, -*b.strain_at_break.value);
}

TEST(TensionFigures, ARunningMeanKeepsAStraightLine) {
  EXPECT_EQ(running_mean({1, 2, 3, 4, 5}, 3), (std::vector<double>{1, 2, 3, 4, 5}));
  EXPECT_EQ(running_mean({0, 3, 0, 3, 0}, 3), (std::vector<double>{0, 1, 2, 1, 0}));
}

}  // namespace
}  // namespace cuboct::test
