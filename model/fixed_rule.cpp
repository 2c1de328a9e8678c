// SPDX-License-Identifier: MIT
#include "model/fixed_rule.h"

#include <bit>
#include <cstdlib>

#include "model/fixed_math.h"

namespace cuboct {

FixedTable::Address FixedTable::address(uint64_t r2) const {
  const uint64_t t_mask = (uint64_t{1} << fraction_bits) - 1;
  if (shape == TableShape::uniform) {
    const int below = 2 * difference_frac - index_bits;
    return {static_cast<uint32_t>(r2 >> below),
            static_cast<uint32_t>(r2 >> (below - fraction_bits) & t_mask)};
  }
  const int octave = std::bit_width(r2) - 1;
  if (octave < first_octave) return {0, 0};
  const uint64_t mantissa = r2 ^ (uint64_t{1} << octave);
  const int spare =
      octave - bin_bits - fraction_bits;  // bits of r2 below t; negative: t is padded with zeros
  const uint64_t bin_and_t = spare >= 0 ? mantissa >> spare : mantissa << static_cast<unsigned>(-spare);
  const auto row = static_cast<uint32_t>(octave - first_octave);
  return {(row << bin_bits) + static_cast<uint32_t>(bin_and_t >> fraction_bits),
          static_cast<uint32_t>(bin_and_t & t_mask)};
}

int64_t FixedTable::at(uint64_t r2) const {
  const auto [k, t] = address(r2);
  int64_t slope = c1[k];
  if (degree == 2) slope += round_odd(int64_t{c2[k]} * t, fraction_bits);
  return c0[k] + round_odd(slope * t, fraction_bits);
}

Int3 difference(const FixedRule& rule, const Int3& x_i, const Int3& x_j) {
  Int3 d;
  for (int a = 0; a < 3; ++a) d[a] = round_odd(x_j[a] - x_i[a], rule.difference_shift);
  return d;
}

bool may_interact(const FixedRule& rule, const Int3& d) {
  const int64_t x = std::abs(d[0]), y = std::abs(d[1]), z = std::abs(d[2]);
  return x <= rule.planar[0] && y <= rule.planar[0] && z <= rule.planar[0] && x + y <= rule.planar[1] &&
         y + z <= rule.planar[1] && z + x <= rule.planar[1] && x + y + z <= rule.planar[2];
}

PairResult pair_kick(const FixedRule& rule, const Int3& x_i, const Int3& v_i, int type_i, const Int3& x_j,
                     const Int3& v_j, int type_j) {
  PairResult result;
  const Int3 d = difference(rule, x_i, x_j);
  const auto r2 = static_cast<uint64_t>(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  if (r2 >= rule.cutoff2) return result;
  result.inside = true;
  const auto fail = [&result](Fault fault, int64_t number) {
    if (result.fault == Fault::none) result.fault = fault, result.number = number;
  };

  int64_t s = rule.force.at(r2);
  if (rule.damped) {
    const int w_bits = rule.widths.relative_velocity_bits;
    int64_t wd = 0;
    for (int a = 0; a < 3; ++a) {
      const int64_t w = round_odd(v_j[a] - v_i[a], rule.w_shift);
      if (!fits(w, w_bits)) fail(Fault::relative_velocity, w);
      wd += wrap(w, w_bits) * d[a];
    }
    const int64_t q = round_odd(wd, rule.q_shift);
    s -= round_odd(rule.damp.at(r2) * q, rule.damp_shift);
    if (!fits(s, rule.widths.strength_bits)) fail(Fault::strength, s);
    s = wrap(s, rule.widths.strength_bits);
  }
  if (rule.scaled) s = round_odd(s * rule.scale[type_i][type_j], rule.widths.scale_frac);
  for (int a = 0; a < 3; ++a) result.kick[a] = -round_odd(s * d[a], rule.kick_shift);
  return result;
}

FinishResult finish(const FixedRule& rule, const Int3& sum, const Int3& x, const Int3& v, const Int3& u,
                    int type) {
  const Widths& widths = rule.widths;
  const FixedType& kind = rule.types[type];
  FinishResult result;
  const auto check = [&result](int64_t value, int bits, Fault fault) {
    if (!fits(value, bits) && (result.fault == Fault::none || fault < result.fault)) {
      result.fault = fault;
      result.number = value;
    }
    return wrap(value, bits);
  };
  for (int a = 0; a < 3; ++a) {
    const int64_t to_go = kind.velocity[a];
    if (kind.imposed[a]) {
      result.v[a] = to_go;  // the sum is not used, so it may be of any size
    } else {
      int64_t dv = check(sum[a], widths.sum_bits, Fault::sum);
      if (kind.pd) dv -= round_odd(kind.kp * u[a] + kind.kd * (v[a] - to_go), widths.gain_frac);
      result.v[a] = check(v[a] + dv + kind.gravity[a], widths.velocity_bits, Fault::velocity);
    }
    if (kind.pd)
      result.u[a] = check(u[a] + result.v[a] - to_go, widths.displacement_bits, Fault::displacement);
    result.x[a] = x[a] + round_odd(result.v[a], widths.guard);
  }
  return result;
}

}  // namespace cuboct
