// SPDX-License-Identifier: MIT
// Results that nobody measured: numbers made up by formulas of the size and shape that a study of a small
// coupon has, for tests of what a report makes of them. They say nothing about cuboct.
#pragma once

#include "study/sweep/store.h"

namespace cuboct::test {

// Doubles, floats and fixed over time steps, threads, tables and widths; unstable and refused points; exact
// momentum; points of two engines, "gpu" and "fpga", that cuboct's own studies do not have.
study::Results made_up_results();

// A few of them in which each text is tests/support/hostile.h's.
study::Results hostile_results();

}  // namespace cuboct::test
