// SPDX-License-Identifier: MIT
// What operations of a graph (graph.h) do to one lane, for machines that run them one by one and for what
// emit_integers.h prints. The names without a suffix are those of interpret.h, which does the same to blocks.
#pragma once

#include <cstdint>

#include "model/base/hash.h"
#include "model/graph/table_value.h"

namespace cuboct::graph {

// round_odd of a number that, with the half that is added to it, fits 32 bits; s > 0.
CUBOCT_HD constexpr int32_t round_odd_32(int32_t a, int s) {
  return (a + (int32_t{1} << (s - 1)) - (a < 0)) >> s;
}

// Op::msb, align, shift and noise.
CUBOCT_HD constexpr int leading_of(int64_t a) { return a <= 0 ? -1 : leading_bit(static_cast<uint64_t>(a)); }

CUBOCT_HD constexpr int64_t aligned_of(int64_t a, int place, int step) {
  if (a <= 0) return 0;
  const int by = place - leading_of(a) / step * step;
  return by >= 0 ? a << by : a >> -by;
}

CUBOCT_HD constexpr int64_t shifted_of(int64_t a, int64_t by) {
  return by >= 0 ? a << by : round_odd(a, static_cast<int>(-by));
}

CUBOCT_HD constexpr int64_t mixed_of(int64_t seed, int64_t a, int64_t b, int64_t c, int width) {
  const uint64_t mixed = Hash().add(seed).add(a < b ? a : b).add(a < b ? b : a).add(c).value();
  return static_cast<int64_t>(mixed) >> (64 - width);
}

}  // namespace cuboct::graph
