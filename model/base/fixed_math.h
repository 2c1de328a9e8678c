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

// A shift with what round_odd makes of it, for where a rounding is repeated and its shift is known at run
// time alone.
struct Rounding {
  int shift = 0;
  int32_t odd = 0;   // -1, which a negative number's sign masks; 0 where nothing is rounded
  int64_t half = 0;  // 2^(shift-1), 0 where nothing is rounded

  Rounding() = default;
  CUBOCT_HD constexpr Rounding(int s)
      : shift(s), odd(s > 0 ? -1 : 0), half(s > 0 ? int64_t{1} << (s - 1) : 0) {}
  CUBOCT_HD constexpr operator int() const { return shift; }
};
CUBOCT_HD constexpr int64_t round_odd(int64_t a, const Rounding& by) {
  return (a + by.half + (static_cast<int32_t>(a >> 63) & by.odd)) >> by.shift;
}

// a b, of all bits. nvcc multiplies what it once widened as 64 by 64 bits, in four instructions and not in
// one.
CUBOCT_HD constexpr int64_t product(int32_t a, int32_t b) {
#ifdef __CUDA_ARCH__
  if (!__builtin_is_constant_evaluated()) {
    int64_t both;
    asm("mul.wide.s32 %0, %1, %2;" : "=l"(both) : "r"(a), "r"(b));
    return both;
  }
#endif
  return int64_t{a} * b;
}

// Whether `a` is representable in `bits` bits, two's complement.
CUBOCT_HD constexpr bool fits(int64_t a, int bits) { return a >> (bits - 1) == a >> 63; }

// The value that `bits` bits of two's complement keep of `a`.
CUBOCT_HD constexpr int64_t wrap(int64_t a, int bits) {
  return static_cast<int64_t>(static_cast<uint64_t>(a) << (64 - bits)) >> (64 - bits);
}

}  // namespace cuboct
