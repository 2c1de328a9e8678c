// SPDX-License-Identifier: MIT
// Steps of something, timed by the wall clock.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <functional>

#include "model/base/clock.h"

namespace cuboct {

// Times `step` for about so many seconds in each repetition; answers the steps of one. The number is found in
// the first, which warms up, and then stays.
class Timed {
 public:
  explicit Timed(double seconds) : seconds_(seconds) {}

  void run(benchmark::State& state, const std::function<void()>& step) {
    if (steps_ == 0) {
      for (int k = 0; k < 3; ++k) step();  // memory is touched, lists are made
      const auto begin = Clock::now();
      uint64_t warm = 0;
      for (; warm < 1 || (seconds_since(begin) < 0.3 * seconds_ && warm < 1000); ++warm) step();
      steps_ = std::max<uint64_t>(
          1, static_cast<uint64_t>(seconds_ * static_cast<double>(warm) / seconds_since(begin)));
    }
    for (auto _ : state) {
      const auto begin = Clock::now();
      for (uint64_t k = 0; k < steps_; ++k) step();
      state.SetIterationTime(seconds_since(begin));
    }
  }
  uint64_t steps() const { return steps_; }

 private:
  double seconds_;
  uint64_t steps_ = 0;
};

}  // namespace cuboct
