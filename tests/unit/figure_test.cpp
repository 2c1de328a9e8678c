// SPDX-License-Identifier: MIT
// Numbers out of made curves whose answers are known.
#include "model/trace/figure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "model/base/error.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

constexpr double kDt = 1e-3;

Curve made(const std::string& name, size_t samples, uint64_t every, double (*value)(double t)) {
  Curve curve{name, "Pa", {}, {}};
  for (size_t k = 0; k < samples; ++k) {
    curve.step.push_back(k * every);
    curve.value.push_back(value(static_cast<double>(k * every) * kDt));
  }
  return curve;
}

Figure figure(Figure::Kind kind, const std::string& curve, double from = 0, double to = 0) {
  Figure f;
  f.kind = kind;
  f.name = "it";
  f.curve = curve;
  f.against = "a.strain";
  f.from = from, f.to = to;
  return f;
}

TEST(Figure, ModulusIsTheSlopeInItsWindow) {
  const std::vector<Curve> curves{
      made("a.stress", 100, 1, [](double t) { return t < 0.05 ? 7 * t + 1 : 9.0; }),
      made("a.strain", 100, 1, [](double t) { return 2 * t; })};
  EXPECT_NEAR(value_of(figure(Figure::Kind::modulus, "a.stress", 0.01, 0.09), curves, kDt), 3.5, 1e-12);
  EXPECT_GT(value_of(figure(Figure::Kind::modulus, "a.stress"), curves, kDt), 10);  // the jump outside counts
}

TEST(Figure, StrengthIsTheTopOfAParabola) {
  // The top, 5 at t = 0.0333, lies between two samples; the parabola is exact.
  const auto bow = [](double t) { return 5 - 1e3 * (t - 0.0333) * (t - 0.0333); };
  const std::vector<Curve> curves{made("a", 20, 7, bow)};
  EXPECT_NEAR(value_of(figure(Figure::Kind::strength, "a"), curves, kDt), 5, 1e-12);
  EXPECT_LT(*std::max_element(curves[0].value.begin(), curves[0].value.end()), 5 - 1e-3);
}

TEST(Figure, FrequencyBetweenBins) {
  // 12.3456 Hz in 1 s of samples: bins of 1 Hz. A second, weaker tone and an offset do not move it by 1e-4.
  const auto tone = [](double t) {
    using std::numbers::pi;
    return 3 + std::sin(2 * pi * 12.3456 * t + 0.7) + 0.3 * std::cos(2 * pi * 31 * t);
  };
  const std::vector<Curve> curves{made("a", 500, 2, tone)};
  EXPECT_NEAR(value_of(figure(Figure::Kind::frequency, "a"), curves, kDt), 12.3456, 12.3456e-4);
  EXPECT_EQ(figure(Figure::Kind::frequency, "a").unit(curves), "Hz");
}

TEST(Figure, BreakTimeIsTheLastCrossing) {
  // Up to 10 at t = 0.1, a dip below half and back, then down for good: 5 is crossed at 0.55.
  const auto load = [](double t) {
    if (t < 0.1) return 100 * t;
    if (t > 0.2 && t < 0.3) return 2.0;
    return t < 0.5 ? 10.0 : 10 - 100 * (t - 0.5);
  };
  const std::vector<Curve> curves{made("a", 70, 9, load)};
  EXPECT_NEAR(value_of(figure(Figure::Kind::break_time, "a"), curves, kDt), 0.55, 1e-9);
  const std::vector<Curve> whole{made("a", 50, 9, load)};
  EXPECT_THROW(value_of(figure(Figure::Kind::break_time, "a"), whole, kDt), std::runtime_error);
}

// A curve that never rises has no part of its largest value to fall below.
TEST(Figure, BreakTimeNeedsAPositiveMaximum) {
  const auto refusal = [](const Curve& curve) -> std::string {
    try {
      return std::to_string(value_of(figure(Figure::Kind::break_time, "a"), {curve}, kDt));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal({"a", "N", {0}, {-4}}), "it: a has no value above 0: the largest is -4");
  EXPECT_EQ(refusal({"a", "N", {0, 1, 2}, {-2, -1.5, -3}}),
            "it: a has no value above 0: the largest is -1.5");
  EXPECT_EQ(refusal({"a", "N", {0, 1}, {0, -3}}), "it: a has no value above 0: the largest is 0");
}

// A window that holds nothing is told beside what there is.
TEST(Figure, AnEmptyWindowIsToldBesideTheCurve) {
  const std::vector<Curve> curves{made("a.stress", 101, 1, [](double t) { return t; }),
                                  made("a.strain", 101, 1, [](double t) { return t / 2; })};
  const auto refusal = [&](const Figure& of) -> std::string {
    try {
      return std::to_string(value_of(of, curves, kDt));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(
      refusal(figure(Figure::Kind::modulus, "a.stress", 0.5, 0.9)),
      "it: 0 samples of a.strain between 0.5 and 0.9, of 101 from 0 to 0.05: at least 2 that differ are "
      "needed");
  EXPECT_EQ(refusal(figure(Figure::Kind::mean, "a.stress", 7)),
            "it: 0 samples of the times of a.stress from 7 on, of 101 from 0 to 0.1");
  EXPECT_EQ(
      refusal(figure(Figure::Kind::frequency, "a.stress", 0.09, 0.095)),
      "it: 6 samples of the times of a.stress between 0.09 and 0.095, of 101 from 0 to 0.1: at least 16 are "
      "needed");
}

TEST(Figure, MeanAndFinal) {
  const std::vector<Curve> curves{made("a", 101, 10, [](double t) { return t; })};
  EXPECT_NEAR(value_of(figure(Figure::Kind::mean, "a", 0.2, 0.4), curves, kDt), 0.3, 1e-12);
  EXPECT_NEAR(value_of(figure(Figure::Kind::final, "a"), curves, kDt), 1, 1e-12);
}

TEST(Figure, SayWhatIsMissing) {
  const std::vector<Curve> curves{made("a.stress", 10, 1, [](double t) { return t; })};
  EXPECT_EQ(refused_with([&] { value_of(figure(Figure::Kind::final, "a.stres"), curves, kDt); }),
            "no curve 'a.stres'\n  hint: did you mean 'a.stress'?");
  EXPECT_THROW(value_of(figure(Figure::Kind::frequency, "a.stress"), curves, kDt), std::runtime_error);
}

Figure read(const std::string& text) {
  return read_figure(parse_config(text, "s.toml").at("figure").table());
}

TEST(Figure, IsReadFromAFile) {
  const Figure f = read("[figure]\nkind = \"modulus\"\ncurve = \"pull.stress\"\nfrom = 0.001\nto = 0.005\n");
  EXPECT_EQ(f.kind, Figure::Kind::modulus);
  EXPECT_EQ(f.name, "modulus");
  EXPECT_EQ(f.against, "pull.strain");
  EXPECT_EQ(f.to, 0.005);
  EXPECT_NEAR(read("[figure]\nkind = \"mean\"\ncurve = \"a\"\nfrom = \"2 ms\"\n").from, 2e-3, 1e-15);
  EXPECT_EQ(refused_with([&] { read("[figure]\nkind = \"modulos\"\ncurve = \"a\"\n"); }),
            "s.toml:2:8: unknown figure 'modulos'\n  hint: did you mean 'modulus'?");
  EXPECT_THROW(read("[figure]\nkind = \"final\"\ncurve = \"a\"\nfraction = 0.5\n"), InputError);
}

}  // namespace
}  // namespace cuboct
