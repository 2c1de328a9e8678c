// SPDX-License-Identifier: MIT
// The benchmarks of the engines.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <vector>

namespace cuboct {

struct BenchLength {
  int repeats = 5;
  double seconds = 0.5;  // per repeat
};

struct Bench {
  std::string name, what;
  std::function<void(benchmark::State&)> run;
  bool once = false;  // a run of given length: three repeats at most
  bool gpu = false;   // repeats by itself
};

// `threads`: of "all cores"; 0: every core.
std::vector<Bench> benches(const BenchLength& length, int threads);

}  // namespace cuboct
