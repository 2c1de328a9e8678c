// SPDX-License-Identifier: MIT
// When the runs of a study are looked at: at the same times, whatever their time steps.
#pragma once

#include <cmath>
#include <cstdint>

namespace cuboct::study {

// Times 0, sample, 2 sample, ..., samples * sample. A figure read from curves that were sampled at other
// times would differ by more than the methods do; so would positions at another time.
struct TimeGrid {
  double sample = 0;     // s
  uint64_t samples = 0;  // >= 1
  uint64_t horizon = 0;  // the sample at which trajectories are compared

  double duration() const { return sample * static_cast<double>(samples); }
  double horizon_time() const { return sample * static_cast<double>(horizon); }
  // Steps from sample to sample: the least number whose steps are no longer than `dt`, but for rounding.
  uint64_t steps_per_sample(double dt) const {
    return static_cast<uint64_t>(std::fmax(1.0, std::ceil(sample / dt * (1 - 1e-9))));
  }
  // `dt` made shorter, so that a whole number of steps is one sample.
  double fitted(double dt) const { return sample / static_cast<double>(steps_per_sample(dt)); }
};

}  // namespace cuboct::study
