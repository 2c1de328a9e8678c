// SPDX-License-Identifier: MIT
#include "emu/lattice/kernel_rule.h"

#include <bit>
#include <cmath>

namespace cuboct::emu {
namespace {

constexpr int kExact = 51;  // |value| < 2^51 beside kMagic

KernelTable kernel_table(const FixedTable& table, int strength_bits) {
  KernelTable k;
  k.octaves = table.shape == TableShape::octaves;
  k.degree = table.degree;
  // c1 takes sign, exponent and strength_bits - 2 bits of mantissa.
  const int low_bits = 64 - 12 - std::max(strength_bits - 2, 0);
  k.low_mask = (uint64_t{1} << low_bits) - 1;
  const int64_t half = int64_t{1} << (low_bits - 1);
  k.bias = kMagic + static_cast<double>(half);
  for (size_t n = 0; n < table.c0.size(); ++n) {
    const auto c1 = std::bit_cast<uint64_t>(static_cast<double>(table.c1[n]));
    k.words.push_back((c1 & ~k.low_mask) | static_cast<uint64_t>(table.c0[n] + half));
  }
  for (const int32_t c : table.c2) k.c2.push_back(c);
  // The double r2 = 2^o (1 + m) has o + 1023 above the 52 bits of m; r2 + 2^52 has r2 in its lowest bits.
  k.index_shift = k.octaves ? 52 - table.bin_bits : 2 * table.difference_frac - table.index_bits;
  k.index_mask = (uint64_t{1} << table.index_bits) - 1;
  k.index_base = k.octaves ? static_cast<int64_t>(1023 + table.first_octave) << table.bin_bits : 0;
  const int below_t = k.index_shift - table.fraction_bits;
  k.t_mask = ((uint64_t{1} << table.fraction_bits) - 1) << below_t;
  k.t_factor = std::ldexp(rounding_factor(table.fraction_bits), -below_t);
  k.narrow_t_factor =
      std::ldexp(rounding_factor(table.fraction_bits, strength_bits + table.fraction_bits), -below_t);
  return k;
}

}  // namespace

double rounding_factor(int shift, int e) {
  return shift == 0 ? 1.0 : std::ldexp(1.0 + std::ldexp(1.0, -e), -shift);
}

KernelRule kernel_rule(const FixedRule& rule, int capacity) {
  const Widths& w = rule.widths;
  KernelRule k;
  k.rule = &rule;
  k.cell = std::ldexp(1.0, w.position_frac);
  k.inverse_cell = std::ldexp(1.0, -w.position_frac);
  k.difference_factor = rounding_factor(rule.difference_shift);
  k.cutoff2 = static_cast<double>(rule.cutoff2);
  k.force = kernel_table(rule.force, w.strength_bits);
  k.kick_factor = rounding_factor(rule.kick_shift);
  k.narrow_kick_factor = rounding_factor(rule.kick_shift, w.strength_bits + w.difference_frac);
  k.damped = rule.damped;
  if (rule.damped) {
    k.damp = kernel_table(rule.damp, w.strength_bits);
    k.w_factor = rounding_factor(rule.w_shift);
    k.q_factor = rounding_factor(rule.q_shift);
    k.damp_factor = rounding_factor(rule.damp_shift);
  }
  k.w_limit = std::ldexp(1.0, w.relative_velocity_bits - 1);
  k.s_high = std::ldexp(1.0, w.strength_bits - 1);
  k.s_low = -k.s_high;
  k.scaled = rule.scaled;
  k.types = static_cast<int>(rule.types.size());
  if (rule.scaled)
    for (const auto& row : rule.scale) k.scale.insert(k.scale.end(), row.begin(), row.end());
  for (const auto& row : rule.law)
    for (const uint8_t law : row) k.first.push_back(int64_t{law} << rule.force.index_bits);
  k.contact2 = static_cast<double>(rule.contact2);
  k.scale_factor = rounding_factor(w.scale_frac);
  k.guard = std::ldexp(1.0, w.guard);
  k.inverse_guard = std::ldexp(1.0, -w.guard);
  k.sum_limit = std::ldexp(1.0, w.sum_bits - 1);
  k.v_limit = std::ldexp(1.0, w.velocity_bits - 1);
  k.weighted = rule.weighted;
  for (const FixedType& type : rule.types) k.weight.push_back(static_cast<double>(type.weight));
  for (const FixedType& type : rule.types)
    k.plain.push_back(!type.pd && !type.imposed[0] && !type.imposed[1] && !type.imposed[2]);

  // What each step of the pair term can reach. |d| <= 2^D inside the cutoff, which is at most one cell edge.
  const int D = w.difference_frac, S = w.strength_bits - 1;
  const int partners = static_cast<int>(std::bit_width(static_cast<unsigned>(27 * capacity)));
  const int T = std::max(rule.force.fraction_bits, rule.damped ? rule.damp.fraction_bits : 0);
  // Bits of s (of t) and of the factor: 1 + 2^-(S + 1 + D), 1 + 2^-(S + 1 + T).
  k.narrow = S + (S + 1 + D) <= 53 && T + (S + 1 + T) <= 53;
  k.fits = 2 * D + 4 <= 52 && S + 1 + T + 1 <= kExact && S + D <= kExact &&
           S + D - rule.kick_shift + partners < kExact && w.velocity_bits <= kExact && S + 1 + 18 <= kExact &&
           2 * (w.strength_bits) + 10 <= 64;
  if (rule.damped)
    k.fits =
        k.fits && w.relative_velocity_bits - 1 + D + 2 <= kExact && S + w.relative_velocity_bits - 1 < kExact;
  return k;
}

}  // namespace cuboct::emu
