// SPDX-License-Identifier: MIT
// The fixed rule as the vector kernels take it: integers in doubles.
//
// Every value of the contract is an integer below 2^52, so a double holds it exactly, and one fused
// multiply-add does what the contract says in three steps. With M = 1.5 * 2^52, doubles around M are spaced
// by 1, so
//   fma(a, 2^-s (1 + 2^-52), M + b) = M + b + round(a / 2^s (1 + 2^-52)),
// rounded once, to nearest. If a / 2^s is a half (s >= 1), the factor moves it away from zero by less than
// 2^-s, as |a| < 2^52; it moves nothing else across a half, as a / 2^s keeps a distance of at least 2^-s
// from any half that it is not equal to. So the sum is b + round_odd(a, s), and no order of summation and no
// width of a vector can change it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/contract/fixed_rule.h"

namespace cuboct::emu {

inline constexpr double kMagic = 6755399441055744.0;  // 1.5 * 2^52

// 2^-shift (1 + 2^-e), or 1 where nothing is rounded: for |a| < 2^e.
double rounding_factor(int shift, int e = 52);

// A FixedTable whose c0 and c1 come with one gather: the upper bits of a word are c1 as a double (whose
// mantissa ends early, as c1 has few bits), the lower `low_bits` are c0 + 2^(low_bits - 1).
struct KernelTable {
  bool octaves = false;
  int degree = 1;
  std::vector<uint64_t> words;
  std::vector<double> c2;  // degree 2
  uint64_t low_mask = 0;
  double bias = 0;  // kMagic + 2^(low_bits - 1)
  // With `bits` those of r2 + 2^52 (uniform) or of r2 itself (octaves): index = bits >> index_shift, less
  // index_base, t 2^k = bits & t_mask. Where the index is negative, both are 0.
  int index_shift = 0;
  uint64_t index_mask = 0;
  int64_t index_base = 0;
  uint64_t t_mask = 0;
  double t_factor = 1;  // rounding_factor of a product with t, over 2^k
  // The same for narrow widths: t_factor * t is exact, and so is this times 2^52.
  double narrow_t_factor = 1;
};

struct KernelRule {
  const FixedRule* rule = nullptr;
  bool fits = false;  // every product and sum stays below 2^52: the vector kernels may be used
  double cell = 0;    // 2^P
  double inverse_cell = 0;
  double difference_factor = 0;
  double cutoff2 = 0;
  KernelTable force;
  double kick_factor = 0;
  // Widths so narrow that a rounding factor can be multiplied into s, and into t, exactly: one multiplication
  // less for each product.
  bool narrow = false;
  double narrow_kick_factor = 0;
  bool damped = false;
  KernelTable damp;
  double w_factor = 0, q_factor = 0, damp_factor = 0;
  double w_limit = 0;            // |w| from here on may not fit
  double s_low = 0, s_high = 0;  // s outside [low, high) does not fit
  bool scaled = false;
  int types = 1;
  std::vector<double> scale;  // types x types; negative: the two only touch
  // Types x types, where the entries of the pair's law begin in `force`; empty where there is one law.
  std::vector<int64_t> first;
  double contact2 = 0;
  double scale_factor = 0;
  bool weighted = false;
  std::vector<double> weight;           // by type, 2^kWeightFrac for the lightest
  double guard = 0, inverse_guard = 0;  // 2^G, 2^-G
  double sum_limit = 0, v_limit = 0;    // |value| from here on may not fit
  std::vector<uint8_t> plain;           // by type: neither imposed nor held by force
};

// `capacity`: of a node; it bounds how many kicks a sum holds.
KernelRule kernel_rule(const FixedRule& rule, int capacity);

}  // namespace cuboct::emu
