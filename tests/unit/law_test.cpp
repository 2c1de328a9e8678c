// SPDX-License-Identifier: MIT
#include "model/contract/law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <unsupported/Eigen/Splines>

#include "model/base/error.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

struct Named {
  std::string name;
  std::shared_ptr<const PairLaw> law;
  std::vector<double> joints;  // between which the law is smooth, from 0 to the cutoff
};

const std::vector<double> kR{0.3, 0.55, 0.8, 1.0, 1.15, 1.4, 1.9};
const std::vector<double> kF{2.0, 1.9, 0.9, 0.0, -0.4, 0.1, 0.0};

std::vector<Named> all_laws() {
  std::vector<Named> laws;
  laws.push_back({"lennard_jones", lennard_jones(1.3, 0.9, 2.2, 0.7), {0, 0.7, 2.2}});
  std::vector<double> joints{0, 0.5};
  joints.insert(joints.end(), kR.begin() + 1, kR.end());
  laws.push_back({"smoothed", lennard_jones(1.3, 0.9, 2.2, 0.7, Smoothing::linear), {0, 0.7, 2.2}});
  laws.push_back({"monotone_cubic", spline_law(kR, kF, Interpolation::monotone_cubic, 0.5), joints});
  joints = {0, 0.5};
  for (size_t k = 1; k + 2 < kR.size(); ++k) joints.push_back((kR[k] + kR[k + 1]) / 2);
  joints.push_back(kR.back());
  laws.push_back({"b_spline", spline_law(kR, kF, Interpolation::b_spline, 0.5), joints});
  for (const char* name : {"elastic", "brittle", "ductile", "viscous"}) {
    std::vector<double> at{0, 0.5};
    for (const double r : {1.0, 1.03, 1.06, 1.09, 1.16, 1.20, 1.27, 1.35, std::numbers::sqrt2})
      at.push_back(r);
    laws.push_back({name, preset_law(name, 1.0, 1.0), at});
  }
  return laws;
}

// The integral of the force from a to b by Gauss-Legendre of order 10, which is exact for the pieces of the
// splines.
double integral(const PairLaw& law, double a, double b) {
  static const double x[5] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                              0.9739065285171717};
  static const double w[5] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820, 0.1494513491505806,
                              0.0666713443086881};
  double sum = 0;
  constexpr int kParts = 64;
  for (int part = 0; part < kParts; ++part) {
    const double half = (b - a) / (2 * kParts), middle = a + (2 * part + 1) * half;
    for (int k = 0; k < 5; ++k)
      sum += half * w[k] * (law.force(middle + half * x[k]) + law.force(middle - half * x[k]));
  }
  return sum;
}

TEST(Law, EnergyIsTheIntegralOfTheForceToTheCutoff) {
  int checked = 0;
  for (const Named& law : all_laws()) {
    double rest = 0;
    for (size_t k = law.joints.size() - 1; k-- > 0;) {
      const double middle = (law.joints[k] + law.joints[k + 1]) / 2;
      EXPECT_NEAR(law.law->energy(middle), rest + integral(*law.law, middle, law.joints[k + 1]), 2e-13)
          << law.name;
      rest += integral(*law.law, law.joints[k], law.joints[k + 1]);
      EXPECT_NEAR(law.law->energy(law.joints[k]), rest, 2e-12 * std::max(1.0, std::abs(rest))) << law.name;
      ++checked;
    }
    EXPECT_EQ(law.law->energy(law.law->cutoff()), 0) << law.name;
  }
  EXPECT_EQ(checked, 2 + 2 + 7 + 6 + 4 * 10);
}

TEST(Law, SlopeIsTheDerivativeOfTheForce) {
  for (const Named& law : all_laws()) {
    for (size_t k = 0; k + 1 < law.joints.size(); ++k) {
      for (const double part : {0.1, 0.37, 0.8}) {
        const double r = law.joints[k] + part * (law.joints[k + 1] - law.joints[k]), h = 1e-5;
        const double difference = (law.law->force(r + h) - law.law->force(r - h)) / (2 * h);
        EXPECT_NEAR(law.law->slope(r), difference, 1e-6 * std::max(1.0, std::abs(difference)))
            << law.name << " at " << r;
      }
    }
  }
}

TEST(Law, IsLinearBelowTheCoreAndZeroFromTheCutoffOn) {
  for (const Named& law : all_laws()) {
    const double core = law.law->core();
    for (const double part : {0.0, 0.25, 0.999}) {
      EXPECT_NEAR(law.law->force(part * core), part * law.law->force(core), 1e-13 * law.law->force(core))
          << law.name;
    }
    EXPECT_GT(law.law->force(core), 0) << law.name;
    for (const double factor : {1.0, 1.0000001, 2.0}) {
      const double r = factor * law.law->cutoff();
      EXPECT_EQ(law.law->force(r), 0) << law.name;
      EXPECT_EQ(law.law->slope(r), 0) << law.name;
      EXPECT_EQ(law.law->energy(r), 0) << law.name;
    }
    EXPECT_EQ(law.law->cutoff(), law.joints.back());
  }
}

TEST(LennardJones, SmoothedEndsWithoutForce) {
  const double cutoff = 1.5;
  const auto plain = lennard_jones(2, 0.5, cutoff, 0.4);
  const auto smooth = lennard_jones(2, 0.5, cutoff, 0.4, Smoothing::linear);
  const double end = 24 * 2 / 1.5 * (2 * std::pow(3, -12) - std::pow(3, -6));
  for (const double r : {0.4, 0.5, 0.9, 1.49}) {
    EXPECT_NEAR(smooth->force(r), plain->force(r) - end, 1e-15 * std::abs(plain->force(r))) << r;
    EXPECT_NEAR(smooth->energy(r), plain->energy(r) - end * (cutoff - r), 1e-14) << r;
    EXPECT_EQ(smooth->slope(r), plain->slope(r)) << r;
  }
  EXPECT_GT(std::abs(plain->force(cutoff * (1 - 1e-12))), 0.04);
  EXPECT_LT(std::abs(smooth->force(cutoff * (1 - 1e-12))), 1e-12);
}

TEST(LennardJones, HasItsTextbookValues) {
  const auto law = lennard_jones(2.0, 0.5, 1.5, 0.4);
  const double shift = 4 * 2.0 * (std::pow(3.0, -12) - std::pow(3.0, -6));
  EXPECT_NEAR(law->energy(0.5), -shift, 1e-15);
  EXPECT_NEAR(law->force(0.5), 24 * 2.0 / 0.5, 1e-12);
  const double well = 0.5 * std::pow(2.0, 1.0 / 6);
  EXPECT_NEAR(law->energy(well), -2.0 - shift, 1e-14);
  EXPECT_NEAR(law->force(well), 0, 1e-12);
  EXPECT_NEAR(law->slope(well), -36 * std::pow(2.0, 2.0 / 3) * 2.0 / (0.5 * 0.5), 1e-10);  // -U'' in the well
}

TEST(MonotoneCubic, GoesThroughItsPointsAndStaysBetweenThem) {
  const auto law = spline_law(kR, kF, Interpolation::monotone_cubic, 0.5);
  int checked = 0;
  for (size_t k = 1; k + 1 < kR.size(); ++k) {
    EXPECT_DOUBLE_EQ(law->force(kR[k]), kF[k]);
    const double rise = kF[k + 1] - kF[k];
    for (double r = kR[k], last = kF[k]; r < kR[k + 1]; r += 1e-3, ++checked) {
      EXPECT_GE((law->force(r) - last) * rise, -1e-15) << "at " << r;
      last = law->force(r);
    }
  }
  EXPECT_GT(checked, 1000);
}

// Slope at a point between two chords, by hand: chords -2 over 1 and -1 over 2 give the weights 2*2+1 and
// 2+2*1, so m = 9 / (5/-2 + 4/-1) = -18/13.
TEST(MonotoneCubic, SlopesAreWeightedHarmonicMeans) {
  const auto law = spline_law({1, 2, 4}, {4, 2, 0}, Interpolation::monotone_cubic, 1);
  EXPECT_NEAR(law->slope(2), -18.0 / 13, 1e-15);
  // At the end, the parabola through the three points: ((2*2+1)*(-1) - 2*(-2))/3 = -1/3.
  EXPECT_NEAR(law->slope(4 - 1e-9), -1.0 / 3, 1e-8);
  EXPECT_NEAR(law->slope(1), ((2 * 1 + 2) * -2.0 - 1 * -1.0) / 3, 1e-14);
}

TEST(MonotoneCubic, OfTwoPointsIsALine) {
  const auto law = spline_law({1, 3}, {2, -2}, Interpolation::monotone_cubic, 1);
  EXPECT_DOUBLE_EQ(law->force(1.5), 1);
  EXPECT_DOUBLE_EQ(law->slope(2.5), -2);
}

// Eigen's general B-spline as the oracle: the same control polygon on clamped uniform knots.
TEST(BSpline, IsTheCurveThatEigenEvaluates) {
  using Curve = Eigen::Spline<double, 2, 2>;
  const int n = static_cast<int>(kR.size());
  Eigen::Matrix<double, 2, Eigen::Dynamic> controls(2, n);
  for (int k = 0; k < n; ++k) controls.col(k) << kR[k], kF[k];
  Eigen::RowVectorXd knots(n + 3);
  for (int k = 0; k < n + 3; ++k) knots[k] = std::clamp(k - 2, 0, n - 2) / double(n - 2);
  const Curve curve(knots, controls);
  const auto law = spline_law(kR, kF, Interpolation::b_spline, kR[0]);
  int checked = 0;
  for (double t = 0; t < 1; t += 1.0 / 512, ++checked) {
    const Eigen::Matrix<double, 2, 2> at = curve.derivatives<1>(t);
    EXPECT_NEAR(law->force(at(0, 0)), at(1, 0), 1e-14) << "t = " << t;
    EXPECT_NEAR(law->slope(at(0, 0)), at(1, 1) / at(0, 1), 1e-12) << "t = " << t;
  }
  EXPECT_EQ(checked, 512);
}

TEST(BSpline, OfControlsOnALineIsTheLine) {
  const auto law = spline_law({1, 1.2, 2.5, 4}, {3, 2.8, 1.5, 0}, Interpolation::b_spline, 1);
  for (const double r : {1.0, 1.1, 1.7, 2.9, 3.999}) EXPECT_NEAR(law->force(r), 4 - r, 1e-14);
}

TEST(Preset, IsAtRestAtThePitchAndEndsSoftlyAtTheSecondNeighbours) {
  const double pitch = 2e-4, k = 3e4, end = std::numbers::sqrt2 * pitch;
  for (const char* name : {"elastic", "brittle", "ductile", "viscous"}) {
    const auto law = preset_law(name, pitch, k);
    EXPECT_EQ(law->force(pitch), 0) << name;
    EXPECT_DOUBLE_EQ(law->slope(pitch), -k) << name;
    // No curvature: the slope hardly changes on both sides.
    EXPECT_NEAR(law->slope(pitch * 1.001), -k, 1.3e-3 * k) << name;
    EXPECT_NEAR(law->slope(pitch * 0.999), -k, 1e-5 * k) << name;
    EXPECT_EQ(law->cutoff(), end) << name;
    EXPECT_NEAR(law->force(end * (1 - 1e-7)), 0, 1e-10 * k * pitch) << name;
    EXPECT_NEAR(law->slope(end * (1 - 1e-7)), 0, 1e-4 * k) << name;
    // Bound: parting two particles costs energy, so a surface does.
    EXPECT_LT(law->energy(pitch), 0) << name;
    // Nothing is stiffer than the bond at the pitch where it resists, or largest_frequency would not be its
    // own.
    double steepest = 0;
    for (double r = law->core(); r < end; r += 1e-4 * pitch) steepest = std::min(steepest, law->slope(r));
    EXPECT_GE(steepest, -k * (1 + 1e-12)) << name;
  }
}

TEST(Preset, DiffersInStrengthRangeAndHardness) {
  struct Feature {
    double strength, peak, range, hump;
  };
  const auto feature = [](const char* name) {
    const auto law = preset_law(name, 1, 1);
    Feature x{};
    for (double r = 1; r < law->cutoff(); r += 1e-4) {
      const double f = law->force(r);
      if (-f > x.strength) x.strength = -f, x.peak = r;
      if (f < 0) x.range = r;
      x.hump = std::max(x.hump, f);
    }
    return x;
  };
  const Feature elastic = feature("elastic"), brittle = feature("brittle"), ductile = feature("ductile"),
                viscous = feature("viscous");
  EXPECT_NEAR(elastic.strength, 0.4 / 3, 1e-6);
  EXPECT_NEAR(elastic.peak, 1.20, 1e-3);
  EXPECT_NEAR(brittle.strength, 0.04, 1e-6);
  EXPECT_NEAR(ductile.strength, 0.06, 1e-6);
  EXPECT_NEAR(viscous.strength, 0.02, 1e-6);
  EXPECT_LT(brittle.range, 1.14);
  EXPECT_GT(ductile.range, 1.32);
  EXPECT_GT(elastic.range, 1.33);
  EXPECT_GT(viscous.range, 1.41);
  EXPECT_NEAR(brittle.hump, 0.006, 1e-6);
  EXPECT_NEAR(elastic.hump, 0.004, 1e-6);
  EXPECT_NEAR(ductile.hump, 0.006, 1e-6);
  EXPECT_EQ(viscous.hump, 0);
}

// The manual's table of the points is the code's.
// Beyond the pitch the curve is the whole law's, made smaller about (pitch, 0); below it is the same.
TEST(Preset, OfAShorterRangeIsTheSameCurveMadeSmaller) {
  constexpr double kPitch = 2, kStiffness = 3;
  for (const char* name : {"elastic", "brittle", "ductile", "viscous"})
    for (const double range : {0.05, 0.4, 1.0}) {
      const auto whole = preset_law(name, kPitch, kStiffness),
                 part = preset_law(name, kPitch, kStiffness, range);
      EXPECT_NEAR(part->slope(kPitch * (1 + 1e-9)), -kStiffness, 1e-6 * kStiffness);
      EXPECT_NEAR(part->energy(kPitch), range * range * whole->energy(kPitch), 1e-12);
      EXPECT_NEAR(part->cutoff() - kPitch, range * (whole->cutoff() - kPitch), 1e-12);
      for (double x = 0.01; x < 0.5; x += 0.01) {
        EXPECT_NEAR(part->force(kPitch + range * x), range * whole->force(kPitch + x), 1e-12) << name << x;
        EXPECT_EQ(part->force(kPitch - x), whole->force(kPitch - x));
      }
    }
  for (const double range : {0.0, -1.0, 1.1, std::nan("")})
    EXPECT_THROW(preset_law("brittle", kPitch, kStiffness, range), InputError) << range;
}

TEST(Preset, IsAsDocumented) {
  std::ifstream manual(CUBOCT_SOURCE_DIR "/docs/reference/physics.md");
  int points = 0;
  bool in_laws = false;
  for (std::string line; std::getline(manual, line);) {
    char name[16];
    double r, f;
    if (line.starts_with("## ")) in_laws = line == "## Pair laws";
    if (!in_laws || std::sscanf(line.c_str(), "| %15s | %lf | %lf |", name, &r, &f) != 3) continue;
    EXPECT_NEAR(preset_law(name, 1, 1)->force(r), f, 1e-12) << line;
    EXPECT_NEAR(preset_law(name, 1, 1)->slope(r), 0, 1e-12) << line;
    ++points;
  }
  EXPECT_EQ(points, 8);
}

TEST(Law, RefusesWithNumbers) {
  using enum Interpolation;
  EXPECT_EQ(refused_with([] { lennard_jones(-1, 1, 2.5, 0.8); }),
            "lennard_jones: epsilon is -1 J, but must be above 0");
  EXPECT_EQ(refused_with([] { lennard_jones(1, NAN, 2.5, 0.8); }),
            "lennard_jones: sigma is nan m, but must be above 0");
  EXPECT_EQ(refused_with([] { lennard_jones(1, 1, 0.5, 0.8); }),
            "lennard_jones: core 0.8 m is not below the cutoff 0.5 m");
  EXPECT_EQ(refused_with([] {
              spline_law({1, 2}, {1}, monotone_cubic, 1);
            }),
            "spline_law: 2 distances, but 1 forces");
  EXPECT_EQ(refused_with([] { spline_law({1}, {1}, monotone_cubic, 1); }),
            "spline_law: 1 points, but at least 2 are needed");
  EXPECT_EQ(refused_with([] {
              spline_law({1, 2}, {1, 0}, b_spline, 1);
            }),
            "spline_law: 2 points, but at least 3 are needed");
  EXPECT_EQ(refused_with([] {
              spline_law({1, 2, 2}, {1, 0, 0}, b_spline, 1);
            }),
            "spline_law: the distance of point 3 (2 m) is not above that of point 2 (2 m)");
  EXPECT_EQ(refused_with([] {
              spline_law({1, INFINITY}, {1, 0}, monotone_cubic, 1);
            }),
            "spline_law: point 2 is (inf m, 0 N)");
  EXPECT_EQ(refused_with([] {
              spline_law({-1, 2}, {1, 0}, monotone_cubic, 1);
            }),
            "spline_law: the first distance is -1 m, below 0");
  EXPECT_EQ(refused_with([] {
              spline_law({1, 2}, {1, 0}, monotone_cubic, 0.5);
            }),
            "spline_law: core 0.5 m is below the first distance 1 m\n"
            "  hint: below its core a law is linear; let the points start at the core or below");
  EXPECT_EQ(refused_with([] {
              spline_law({0, 2}, {1, 0}, monotone_cubic, 0);
            }),
            "spline_law: core is 0 m, but must be above 0");
  EXPECT_EQ(refused_with([] { preset_law("plastic", 1, 1); }),
            "unknown preset law 'plastic'\n  hint: the presets are elastic, brittle, ductile and viscous");
  EXPECT_EQ(refused_with([] { preset_law("elastic", 0, 1); }),
            "preset_law: pitch is 0 m, but must be above 0");
  EXPECT_EQ(refused_with([] { preset_law("elastic", 1, -2); }),
            "preset_law: stiffness is -2 N/m, but must be above 0");
}

}  // namespace
}  // namespace cuboct
