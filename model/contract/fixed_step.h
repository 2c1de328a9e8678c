// SPDX-License-Identifier: MIT
// The arithmetic of the fixed rule, written once for every machine: for the host over FixedRule
// (model/contract/fixed_rule.h), for a GPU over a rule of plain arrays with the same members. The contract is
// docs/reference/numeric.md.
#pragma once

#include <cstdint>

#include "model/base/fixed_math.h"
#include "model/graph/table_value.h"

namespace cuboct {

inline constexpr int kShapeFrac = 24;  // of FixedRule::shape_of

// A number that counts edges of its own axis, in edges of the longest. Machines know cubes alone: their rules
// have no shape.
template <class Rule>
CUBOCT_HD int32_t shaped_by(const Rule& rule, int axis, int32_t number) {
  if constexpr (requires { rule.shape_of(axis); })
    if (!rule.cubic())
      return static_cast<int32_t>(round_odd(product(number, rule.shape_of(axis)), kShapeFrac));
  return number;
}

// One pair's part of the kick, as PairResult holds it. x_i, x_j: visible positions, `x_j` in the frame of i's
// cell.
template <class Result, class Rule, class Triple>
CUBOCT_HD Result pair_kick_of(const Rule& rule, const Triple& x_i, const Triple& v_i, int type_i,
                              const Triple& x_j, const Triple& v_j, int type_j) {
  using FaultType = decltype(Result::fault);
  Result result;
  // Products of 32 bits by 32: differences have D <= 24 fractional bits of at most four cells, w and s 27
  // bits.
  int32_t d[3];
  for (int a = 0; a < 3; ++a) d[a] = static_cast<int32_t>(round_odd(x_j[a] - x_i[a], rule.difference_shift));
  int32_t e[3];
  for (int a = 0; a < 3; ++a) e[a] = shaped_by(rule, a, d[a]);
  const auto r2 = static_cast<uint64_t>(product(e[0], e[0]) + product(e[1], e[1]) + product(e[2], e[2]));
  if (r2 >= rule.cutoff2) return result;
  int32_t scale = 0;
  uint32_t first = 0;
  if (rule.scaled) {
    scale = rule.scale[type_i][type_j];
    if (scale < 0) {  // the two only touch
      if (r2 >= rule.contact2) return result;
      scale = -scale;
    }
    if (rule.law_bits > 0) first = static_cast<uint32_t>(rule.law[type_i][type_j]) << rule.force.index_bits;
  }
  result.inside = true;
  int64_t s = table_value(rule.force, r2, first);
  if (rule.damped) {
    const int w_bits = rule.widths.relative_velocity_bits;
    int64_t wd = 0;
    for (int a = 0; a < 3; ++a) {
      int64_t w = round_odd(v_j[a] - v_i[a], rule.w_shift);
      if (!fits(w, w_bits)) {
        if (result.fault == FaultType::none) result.fault = FaultType::relative_velocity, result.number = w;
        w = wrap(w, w_bits);
      }
      wd += product(shaped_by(rule, a, static_cast<int32_t>(w)), e[a]);
    }
    const int64_t q = round_odd(wd, rule.q_shift);
    s -= round_odd(table_value(rule.damp, r2) * q, rule.damp_shift);
    if (!fits(s, rule.widths.strength_bits)) {
      if (result.fault == FaultType::none) result.fault = FaultType::strength, result.number = s;
      s = wrap(s, rule.widths.strength_bits);
    }
  }
  auto strength = static_cast<int32_t>(s);
  if (rule.scaled)
    strength = static_cast<int32_t>(round_odd(product(strength, scale), rule.widths.scale_frac));
  for (int a = 0; a < 3; ++a) result.kick[a] = -round_odd(product(strength, d[a]), rule.kick_shift);
  return result;
}

inline constexpr int kWeightFrac = 16;  // of FixedType::weight

// What a summed kick adds to the velocity of a particle of such a type. |sum| < 2^47, so that the product
// fits.
template <class Rule, class Type>
CUBOCT_HD int64_t weighed(const Rule& rule, const Type& kind, int64_t sum) {
  return rule.weighted ? round_odd(sum * kind.weight, kWeightFrac) : sum;
}

// Kick, constraints and drift of one particle, as FinishResult holds it. The drift is exact: x has the
// fractional bits of v.
template <class Result, class Rule, class Triple>
CUBOCT_HD Result finish_of(const Rule& rule, const Triple& sum, const Triple& x, const Triple& v,
                           const Triple& u, int type) {
  using FaultType = decltype(Result::fault);
  const auto& widths = rule.widths;
  const auto& kind = rule.types[type];
  Result result;
  const auto check = [&result](int64_t value, int bits, FaultType fault) {
    if (fits(value, bits)) return value;
    if (result.fault == FaultType::none || fault < result.fault) {
      result.fault = fault;
      result.number = value;
    }
    return wrap(value, bits);
  };
  for (int a = 0; a < 3; ++a) {
    const int64_t target_velocity = kind.velocity[a];
    if (kind.imposed[a]) {
      result.v[a] = target_velocity;  // the sum is not used, so it may be of any size
    } else {
      int64_t dv = weighed(rule, kind, check(sum[a], widths.sum_bits, FaultType::sum));
      if (kind.pd) dv -= round_odd(kind.kp * u[a] + kind.kd * (v[a] - target_velocity), widths.gain_frac);
      result.v[a] = check(v[a] + dv + kind.gravity[a], widths.velocity_bits, FaultType::velocity);
    }
    if (kind.pd)
      result.u[a] =
          check(u[a] + result.v[a] - target_velocity, widths.displacement_bits, FaultType::displacement);
    result.x[a] = x[a] + result.v[a];
  }
  return result;
}

}  // namespace cuboct
