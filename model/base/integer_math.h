// SPDX-License-Identifier: MIT
// Integer divisions, logarithms and conversions.
#pragma once
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace cuboct {

// a / b, rounded up; a >= 0, b > 0.
template <std::integral T>
constexpr T ceil_div(T a, T b) {
  return (a + b - 1) / b;
}

constexpr size_t as_size(int n) { return static_cast<size_t>(n); }  // n >= 0

// Bits that number `n` things; none for one or none.
constexpr int ceil_log2(uint64_t n) { return n <= 1 ? 0 : std::bit_width(n - 1); }

}  // namespace cuboct
