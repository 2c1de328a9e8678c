// SPDX-License-Identifier: MIT
// Numbers that a hint proposes.
#pragma once

#include <cmath>

namespace cuboct {

// Two digits, rounded up; of x > 0.
inline double two_digits_up(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
  return std::ceil(x / unit * (1 - 1e-9)) * unit;
}

}  // namespace cuboct
