// SPDX-License-Identifier: MIT
// How fast two neighbouring runs part.
#pragma once

#include <vector>

#include "study/sweep/settings.h"
#include "study/sweep/time_grid.h"

namespace cuboct::study {

// Distance (rms over particles, m) at each sample between two runs of velocity Verlet in doubles whose
// initial positions differ by 1e-9 of the pitch along axes that are free. Ends early where it passes 1e-3 of
// the pitch.
std::vector<double> separation(const Case& c, const TimeGrid& grid, int threads);

struct Sensitivity {
  double lyapunov_time = 0;  // s; infinite where the distance does not grow exponentially
  uint64_t horizon = 0;      // sample, at least 1, up to which it has grown less than e^3
};

// The Lyapunov time is the inverse slope of the distance's logarithm, by least squares from ten times the
// first distance to the end. It counts where there are 5 samples in which the distance grows by e^2 or more,
// no slower than half as fast in their second half: growth in proportion to time, as of bodies that spin or
// fly apart, is not exponential.
Sensitivity sensitivity_of(const std::vector<double>& distance, double sample);

}  // namespace cuboct::study
