// SPDX-License-Identifier: MIT
// The GPU engines' rows in `cuboct bench`: each is run by cuboct-gpu, which repeats and takes the median
// itself.
#pragma once

#include <benchmark/benchmark.h>

#include <string>

namespace cuboct {

// In a line, why there is nothing to run on: no such program beside cuboct, no device. Else empty.
std::string gpu_left_out();

// `row` is one of gpu::bench_rows().
void run_gpu_row(benchmark::State& state, const std::string& row, int repeats, double seconds);

}  // namespace cuboct
