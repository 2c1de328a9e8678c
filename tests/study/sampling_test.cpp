// SPDX-License-Identifier: MIT
// Which figures depend on the samples: cases to check by hand.
#include "study/sweep/sampling.h"

#include <gtest/gtest.h>

namespace cuboct::study {
namespace {

using Notes = std::vector<std::string>;

constexpr double kDt = 1;

Figure modulus(const std::string& name, const std::string& curve, double from = 0, double to = 0) {
  Figure figure;
  figure.kind = Figure::Kind::modulus;
  figure.name = name;
  figure.curve = curve;
  figure.against = "pull.strain";
  figure.from = from, figure.to = to;
  return figure;
}

// Strains 0 ... 8, a straight line over them, and one with a wave on its odd samples: 0.3 (k - 4) more there.
// Least squares: the sum of (k - 4)^2 is 60, over the odd ones 20, so its slope is 1 + 0.3/3 = 1.1; the even
// samples alone have the slope 1, which is 1/11 = 9.1 % less.
std::vector<Curve> curves() {
  Curve strain{"pull.strain", "", {}, {}}, line{"pull.line", "Pa", {}, {}}, wave{"pull.wave", "Pa", {}, {}};
  for (uint64_t k = 0; k <= 8; ++k) {
    for (Curve* curve : {&strain, &line, &wave}) curve->step.push_back(k);
    const auto x = static_cast<double>(k);
    strain.value.push_back(x);
    line.value.push_back(x);
    wave.value.push_back(k % 2 ? x + 0.3 * (x - 4) : x);
  }
  return {strain, line, wave};
}

TEST(Sampling, AFigureThatTheSamplesDecideIsNamed) {
  const std::vector<Figure> figures{modulus("of the line", "pull.line"), modulus("of the wave", "pull.wave")};
  const Notes expected{
      "of the wave changes by 9.1 % if every second sample is left out: more 'samples', or a wider window, "
      "make it a property of the scene"};
  EXPECT_EQ(sampling_notes(figures, curves(), kDt, 1e-3), expected);
  EXPECT_EQ(sampling_notes(figures, curves(), kDt, 0.09), expected);
  EXPECT_EQ(sampling_notes(figures, curves(), kDt, 0.1), Notes{});
}

// Between 3.5 and 5.5 two samples stand, and one of the even ones; between 8.5 and 9 none.
TEST(Sampling, AFigureThatIsLostIsNamedToo) {
  EXPECT_EQ(sampling_notes({modulus("narrow", "pull.line", 3.5, 5.5), modulus("none", "pull.line", 8.5, 9)},
                           curves(), kDt, 1e-3),
            Notes{"narrow is lost if every second sample is left out: more 'samples', or a wider window, "
                  "make it a property of the scene"});
}

// Also of an even number of samples.
TEST(Sampling, TheLastSampleStays) {
  Figure last;
  last.name = "last";
  last.curve = "pull.line";
  std::vector<Curve> nine = curves(), eight = nine;
  for (Curve& curve : eight) curve.step.pop_back(), curve.value.pop_back();
  EXPECT_EQ(sampling_notes({last}, nine, kDt, 1e-9), Notes{});
  EXPECT_EQ(sampling_notes({last}, eight, kDt, 1e-9), Notes{});
}

}  // namespace
}  // namespace cuboct::study
