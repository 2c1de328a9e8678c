// SPDX-License-Identifier: MIT
// What settings cost, independent of any machine.
#pragma once

#include "hw/plan.h"
#include "study/settings.h"

namespace cuboct::study {

// Area times time per simulated second: the bit products of one pair pipe's multipliers, plus its tables at 6
// transistors a bit against 34 a bit product (an AND gate and a full adder), times the interacting pairs of
// the initial state, times steps per simulated second. Doubles and floats count as a pipe with multipliers of
// 53 and 24 bits and the law by a cubic and a division.
double cost_of(const Case& c);

}  // namespace cuboct::study
