// SPDX-License-Identifier: MIT
// The integer arithmetic that every fixed engine shares. Plain functions, so that a GPU compiler takes them
// too.
#pragma once

#include <cstdint>

#ifdef __CUDACC__
#define CUBOCT_HD __host__ __device__
#else
#define CUBOCT_HD
#endif

namespace cuboct {

// a / 2^s, rounded to nearest, halves away from zero. Odd: round_odd(-a, s) == -round_odd(a, s). s >= 0.
// Derivation: floor((a + 2^(s-1)) / 2^s) rounds halves up; subtracting 1 from a negative `a` first moves
// exactly its halves down and nothing else, as `a` is an integer.
CUBOCT_HD constexpr int64_t round_odd(int64_t a, int s) {
  return s == 0 ? a : (a + (int64_t{1} << (s - 1)) - (a < 0)) >> s;
}

// Whether `a` is representable in `bits` bits, two's complement.
CUBOCT_HD constexpr bool fits(int64_t a, int bits) {
  return a >= -(int64_t{1} << (bits - 1)) && a < (int64_t{1} << (bits - 1));
}

// The value that `bits` bits of two's complement keep of `a`.
CUBOCT_HD constexpr int64_t wrap(int64_t a, int bits) {
  return static_cast<int64_t>(static_cast<uint64_t>(a) << (64 - bits)) >> (64 - bits);
}

}  // namespace cuboct
