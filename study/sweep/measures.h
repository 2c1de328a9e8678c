// SPDX-License-Identifier: MIT
// What outcomes are compared by: their errors and their speeds, each as one number with a name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "study/sweep/store.h"

namespace cuboct::study {

struct Measure {
  enum class Kind : uint8_t { force, trajectory, drift, momentum, figure, speed };
  Kind kind = Kind::force;
  std::string id;     // of [a-z0-9_], unique among errors and among speeds: in file names
  std::string label;  // for axes, with its unit
  bool less_is_better = true;
  double floor = 0;  // what the truth itself is uncertain by in this measure; 0: not known, or negligible
  std::function<double(const Outcome&)> value;  // nan: not measured

  // Larger is better.
  double merit(const Outcome& outcome) const { return less_is_better ? -value(outcome) : value(outcome); }
};

std::vector<double> values_of(const Results& results, const Measure& measure);

// How much figure `n` moved at the last rung of the truth's refinement, relative to its value.
double figure_floor(const Truth& truth, size_t n);

// The worst relative error of an outcome's figures; nan where one was not measured, or there is none.
double worst_figure_error(const Outcome& outcome);

// Those that at least one outcome has: forces, trajectory, drift, momentum, then the study's figures, the
// worst of several first.
std::vector<Measure> error_measures(const Results& results);
// Simulated seconds and particle-steps per second of host time, and the cost that needs no machine.
std::vector<Measure> speed_measures(const Results& results);

}  // namespace cuboct::study
