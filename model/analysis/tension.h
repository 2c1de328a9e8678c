// SPDX-License-Identifier: MIT
// What an engineer reads off a tensile test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct {

// A curve of two readings or more; null where there is none of the name.
const Curve* find_curve(const std::vector<Curve>& curves, const std::string& name);

// The curves of a stress_strain probe: both have the same steps.
struct Tension {
  const Curve *strain = nullptr, *stress = nullptr;
};
std::optional<Tension> tension_of(const std::vector<Curve>& curves, const std::string& probe);

struct TensionFigures {
  // Slope of the least-squares line through the readings of up to 0.5 % before the largest stress, Pa. ISO
  // 527 takes 0.05 to 0.25 %; a run pulled within milliseconds has few readings there, and they ring.
  std::optional<double> modulus;
  double strength = 0;      // the largest stress, of the running mean, Pa
  double yield_strain = 0;  // there
  // The last one at which the running mean is above a tenth of the strength, where it stays below it to the
  // end.
  std::optional<double> strain_at_break;
};

// The mean of each reading and its neighbours, `width` of them, fewer at the ends; `width` is made odd.
std::vector<double> running_mean(const std::vector<double>& values, size_t width);

// Readings that the mean of a test of `count` goes over: a hundredth, for the bar rings where it slips.
size_t tension_window(size_t count);

// Strains and stresses of the same readings, two or more. Throws std::invalid_argument for others.
TensionFigures tension_figures(const std::vector<double>& strain, const std::vector<double>& stress);

}  // namespace cuboct
