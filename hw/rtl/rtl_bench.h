// SPDX-License-Identifier: MIT
// The self-checking bench of an emitted lattice.
#pragma once

#include <map>
#include <string>

#include "hw/plan/plan.h"
#include "hw/rtl/rtl_design.h"
#include "model/contract/state.h"

namespace cuboct {

// Files of the bench by path in the project: testbench, what to load, what to observe in `steps` steps of
// golden, Makefile and README. Throws RunError where golden does.
std::map<std::string, std::string> print_bench(const Plan& plan, const RtlDesign& design,
                                               const State& initial, uint64_t steps);

}  // namespace cuboct
