// SPDX-License-Identifier: MIT
// Random numbers that are a hash of a stream, of two ids without order, and of a third number, such as the
// step: whoever asks gets the same one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "model/base/hash.h"

namespace cuboct::graph {

inline int64_t noise_of(int64_t stream, int64_t a, int64_t b, int64_t c, int width) {
  const uint64_t mixed = Hash().add(stream).add(std::min(a, b)).add(std::max(a, b)).add(c).value();
  return static_cast<int64_t>(mixed) >> (64 - width);
}

// What a rule's text draws: of v of so many bits 2 v + 1, one of N = 2^24 odd numbers between -N and N. Their
// mean is 0, their mean square (N^2 - 1)/3. In the unit below their variance is 1, and they lie between
// -sqrt(3) and sqrt(3).
inline constexpr int kNoiseBits = 24;
inline const double kNoiseUnit = std::sqrt(3 / (std::ldexp(1.0, 2 * kNoiseBits) - 1));
inline constexpr int64_t kNoTime = -1;  // in place of the step: what is drawn once and for all

}  // namespace cuboct::graph
