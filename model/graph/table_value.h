// SPDX-License-Identifier: MIT
// What a table is worth at an argument, written once for every machine: for the host over FixedTable, for a
// GPU over a table of plain arrays with the same members.
#pragma once

#include <cstdint>

#include "model/base/fixed_math.h"

namespace cuboct {

// floor(log2 a), a > 0.
CUBOCT_HD constexpr int leading_bit(uint64_t a) {
#ifdef __CUDA_ARCH__
  return 63 - __clzll(static_cast<long long>(a));
#else
  return 63 - __builtin_clzll(a);
#endif
}

// Where r2 falls in a table: FixedTable in model/graph/fixed_table.h.
template <class Table>
CUBOCT_HD void table_address(const Table& table, uint64_t r2, uint32_t& index, uint32_t& t) {
  const uint32_t t_mask = (uint32_t{1} << table.fraction_bits) - 1;
  if (static_cast<int>(table.shape) == 0) {  // TableShape::uniform
    const int below = 2 * table.difference_frac - table.index_bits;
    index = static_cast<uint32_t>(r2 >> below);
    t = static_cast<uint32_t>(r2 >> (below - table.fraction_bits)) & t_mask;
    return;
  }
  index = t = 0;
  const int octave = r2 > 0 ? leading_bit(r2) : -1;
  if (octave < table.first_octave) return;
  const uint64_t mantissa = r2 ^ (uint64_t{1} << octave);
  // Bits of r2 below t; negative: t is padded with zeros.
  const int spare = octave - table.bin_bits - table.fraction_bits;
  const uint64_t bin_and_t = spare >= 0 ? mantissa >> spare : mantissa << static_cast<unsigned>(-spare);
  const auto row = static_cast<uint32_t>(octave - table.first_octave);
  index = (row << table.bin_bits) + static_cast<uint32_t>(bin_and_t >> table.fraction_bits);
  t = static_cast<uint32_t>(bin_and_t) & t_mask;
}

// `first`: where the entries of the law begin.
template <class Table>
CUBOCT_HD int64_t table_value(const Table& table, uint64_t r2, uint32_t first = 0) {
  uint32_t k, t;
  table_address(table, r2, k, t);
  k += first;
  const auto fraction = static_cast<int32_t>(t);
  if (table.degree == 1) return table.c0[k] + round_odd(product(table.c1[k], fraction), table.fraction_bits);
  const int64_t slope = table.c1[k] + round_odd(product(table.c2[k], fraction), table.fraction_bits);
  return table.c0[k] + round_odd(slope * fraction, table.fraction_bits);
}

}  // namespace cuboct
