// SPDX-License-Identifier: MIT
// A fit's study file. docs/user/fit.md is the reference of the format.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "model/base/mat3.h"
#include "study/law_fit/drawn_law.h"
#include "study/law_fit/target.h"
#include "study/law_fit/virtual_test.h"

namespace cuboct::fit {

// Of one parameter, as docs/user/fit.md has its units.
struct Bounds {
  double low = 0, high = 1;
};

struct Search {
  unsigned samples = 16;    // of a generation
  double threshold = 0.01;  // the search ends where errors fall by less, relatively,
                            // over `patience` generations
  unsigned patience = 10;
  double goal = 0;             // or where the curve's error is no larger
  unsigned generations = 100;  // or after so many
  unsigned seed = 1;
  double spread = 0.2;  // of the first generation, over the bounds
};

struct FitStudy {
  std::string path, title;
  Test test;
  Target target;
  Mat3 axes;       // of the pull (cheap_case.h)
  LawScale scale;  // stiffness and height from the cheap case
  std::array<Bounds, kParameters> bounds;
  Parameters start;  // within the bounds
  Search search;
  uint64_t hash = 0;  // of all that evaluations and their order depend on
};

// Throws InputError with file:line:column.
FitStudy read_fit(const std::string& path);

// Samples of the search have components without limits: beyond 0 and 1 they turn back, as in a mirror.
// Stiffness goes by its logarithm.
Parameters parameters_of(const FitStudy& study, const std::vector<double>& sample);
std::vector<double> sample_of(const FitStudy& study, const Parameters& parameters);

}  // namespace cuboct::fit
