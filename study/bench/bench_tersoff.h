// SPDX-License-Identifier: MIT
// Benchmarks of Tersoff's potential: sheets and blocks in time, and many small samples.
#pragma once

#include <vector>

#include "study/bench/benches.h"

namespace cuboct {

// `seconds`: of a repeat; `all`: threads of "all cores".
std::vector<Bench> tersoff_benches(double seconds, int all);

}  // namespace cuboct
