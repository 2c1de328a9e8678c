// SPDX-License-Identifier: MIT
// What an engineer reads off a tensile test: each number with the stretch of the curve that it comes from and
// how well it is known, or why the curve does not hold it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct {

struct Scene;
struct Probe;

// A curve of two readings or more; null where there is none of the name.
const Curve* find_curve(const std::vector<Curve>& curves, const std::string& name);

// The curves of a stress_strain probe: both have the same steps.
struct Tension {
  const Curve *strain = nullptr, *stress = nullptr;
};
std::optional<Tension> tension_of(const std::vector<Curve>& curves, const std::string& probe);

struct TensionTest {
  std::vector<double> strain, stress, time;  // of the same two or more readings; times ascend
  // In the unit of `time`, of waves along the part of the body that is pulled, from grip to grip and back.
  // Each adds to the stress, which so rises in steps of that length. 0: nothing waves, as under static
  // loading.
  double round_trip = 0;
};
// `probe`: of the scene, whose curves these are. Times are steps.
TensionTest tension_test(const Tension& curves, const Scene& scene, const Probe& probe);

// m, between particles' centres: from grip to grip, or to the body's end where nothing holds it.
double pulled_length(const Scene& scene, const Probe& probe);

struct CurveFigure {
  std::optional<double> value;
  std::string why;          // there is no value
  double from = 0, to = 0;  // strains between which the readings lie that it comes from
  double error = 0;         // standard error of the value
};

struct TensionFigures {
  // Pa: the slope of the straight part, a least-squares line with its own intercept. Strains and stresses are
  // means over a round trip of waves, from when these have gone to and fro once.
  CurveFigure modulus;
  CurveFigure strength;       // Pa: the largest stress, of the running mean, behind the first round trip
  bool rises_at_end = false;  // the strength is the last reading's, and not yet the body's
  CurveFigure
      yield_strain;  // where the strength is, once the curve has left its straight part and rises no more
  CurveFigure strain_at_break;  // the last one at which the running mean is above a tenth of the strength,
                                // where it stays below it to the end
};

// The mean of each reading and its neighbours, `width` of them, fewer at the ends; `width` is made odd.
std::vector<double> running_mean(const std::vector<double>& values, size_t width);

// Readings that the mean of a test of `count` goes over: a hundredth, for the bar rings where it slips.
size_t tension_window(size_t count);

// Of a body that is compressed too: strains and stresses are then below 0. Throws std::invalid_argument for
// curves that are not as TensionTest has them.
TensionFigures tension_figures(const TensionTest& test);

}  // namespace cuboct
