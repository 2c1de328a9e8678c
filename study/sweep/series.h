// SPDX-License-Identifier: MIT
// The points of a study by engine, arithmetic and machine, each with a look of its own.
#pragma once

#include <string>
#include <vector>

#include "study/sweep/store.h"

namespace cuboct::study {

struct Series {
  std::string name;            // "lattice, fixed"; of another machine: "gpu, float (NVIDIA H100)"
  std::string colour;          // "#0072b2"; at least 3:1 against white
  int symbol = 0;              // 0 ... kSymbols - 1, so that colour is never all that tells two apart
  std::vector<size_t> points;  // indices into the outcomes
};

inline constexpr int kSymbols = 6;  // circle, square, triangle, diamond, inverted triangle, pentagon
inline constexpr int kCross = 6;    // of what is unstable

const char* series_colour(size_t k);

const char* label(Arithmetic arithmetic);  // "double", "float", "fixed"
const char* label(Status status);
const char* label(Integrator integrator);

// "lattice, fixed; 4 threads; run.dt_safety 0.1; widths.guard 6": all that tells a point from others.
std::string describe(const Settings& settings);

// The engines of today first, in their own looks; then those from elsewhere, and known ones on further
// machines, in the order of their first points.
std::vector<Series> series_of(const Results& results);

}  // namespace cuboct::study
