// SPDX-License-Identifier: MIT
// A rule in real numbers as GPUs and their host evaluate it: pair kicks in closed form, and the step of one
// particle by semi-implicit Euler. The physics is that of model/real/reference.h.
//
// Units: lengths in cutoffs of the pair law, so that the cutoff is 1; times in steps. A velocity is in
// cutoffs per step, and so is a kick, f dt^2/(m cutoff): no number comes near the ends of a float's range, as
// SI would.
#pragma once

#include <bit>
#include <cstdint>

#include "emu/gpu/real/roots.h"
#include "model/base/fixed_math.h"

namespace cuboct::gpu {

// Crowded: joints so near to each other that some bin of r^2 (below) holds two, which takes a loop.
enum class LawKind : uint8_t {
  lennard_jones,
  shifted_lennard_jones,
  cubic,
  arc,
  crowded_cubic,
  crowded_arc,
  several,  // each pair of types has its own of these
};
constexpr bool is_arc(LawKind kind) { return kind == LawKind::arc || kind == LawKind::crowded_arc; }
constexpr bool has_pieces(LawKind kind) { return kind >= LawKind::cubic && kind != LawKind::several; }
constexpr bool is_crowded(LawKind kind) {
  return kind == LawKind::crowded_cubic || kind == LawKind::crowded_arc;
}

// What a type does to its particles.
template <class Real>
struct RealType {
  Real gravity[3] = {};   // cutoffs per step^2
  Real velocity[3] = {};  // cutoffs per step: imposed, or the PD anchor's
  Real kp = 0, kd = 0;    // per step^2, per step
  Real weight = 1;        // of the summed kicks: the lightest mass over the type's
  bool imposed[3] = {};
  bool pd = false;
};

inline constexpr int kLaws = 4;  // at most

// One law.
template <class Real>
struct RealLaw {
  LawKind kind = LawKind::lennard_jones;
  Real core2 = 0;    // cutoff^2; nearer pairs have the f/r of the core
  Real cutoff2 = 1;  // of the law, in that of the rule, squared
  // Lennard-Jones: f/r = (repulsion/r^6 - attraction)/r^8 + offset/r
  Real repulsion = 0, attraction = 0, offset = 0;
  int first = 0;  // where its coefficients begin in the rule's cache, a multiple of 4
  int bin_shift = 0;
  // From there on: where the bin of no bits would stand, the begins, their squares.
  int bin_at = 0, begin_at = 0, joint_at = 0;
};

// A view: emu/gpu/real/real_tables.h makes it and owns what it points to, or a copy of that on a device. It
// is the law too; of several laws (LawKind::several) it has the shortest core, and `laws` are them.
template <class Real>
struct RealRule : RealLaw<Real> {
  bool damped = false, scaled = false;  // the template arguments of pair_factor
  bool pd = false;                      // some type has a u
  bool constrained = false;             // some type has anything set: imposed axes, PD, gravity, weight
  int type_count = 1;
  Real damping = 0;  // per step
  RealLaw<Real> laws[kLaws];

  // Each law's coefficients: none for Lennard-Jones, else
  //   pieces  4 each, see over_r
  //   bins    2 each: the first joint (cutoff^2) inside the bin, 2 where there is none; and, as an integer's
  //           bits, the piece at the bin's beginning
  //   begins  the r where each piece begins; then that squared, and a 2 at the end
  // A bin is a range of r^2 whose numbers have the same exponent and upper bits: its index is two integer
  // operations away, bins are finer where a law is steeper, and the cutoff is the end of one.
  const Real* cache = nullptr;  // aligned to 16 bytes, as every copy of it
  int cache_size = 0;           // Reals, a multiple of 4

  // type_count x type_count, factor on the pair force; negative: only touch. With several laws as many again:
  // the number of each pair's law.
  const Real* strength = nullptr;
  Real contact2 = 0;  // cutoff^2: from here on pairs that only touch do nothing
  const RealType<Real>* types = nullptr;
};

// The bits that tell the bin of r2 > 0.
CUBOCT_HD constexpr int bin_bits(float r2, int shift) {
  return static_cast<int>(std::bit_cast<uint32_t>(r2) >> shift);
}
CUBOCT_HD constexpr int bin_bits(double r2, int shift) {
  return static_cast<int>(static_cast<uint32_t>(std::bit_cast<uint64_t>(r2) >> 32) >> shift);
}
// An index that travels as a Real.
CUBOCT_HD constexpr int index_in(float bits) { return std::bit_cast<int32_t>(bits); }
CUBOCT_HD constexpr int index_in(double bits) {
  return static_cast<int>(static_cast<uint32_t>(std::bit_cast<uint64_t>(bits)));
}

namespace detail {

template <class Real>
struct Two {
  Real a, b;
};
template <class Real>
struct Four {
  Real a, b, c, d;
};

// Whole vectors in one load, `from` being aligned to their size or to 16 bytes.
template <class Real>
CUBOCT_HD Two<Real> load_two(const Real* from) {
#ifdef __CUDA_ARCH__
  if constexpr (sizeof(Real) == 4) {
    const float2 v = *reinterpret_cast<const float2*>(from);
    return {v.x, v.y};
  } else {
    const double2 v = *reinterpret_cast<const double2*>(from);
    return {v.x, v.y};
  }
#else
  return {from[0], from[1]};
#endif
}
template <class Real>
CUBOCT_HD Four<Real> load_four(const Real* from) {
#ifdef __CUDA_ARCH__
  if constexpr (sizeof(Real) == 4) {
    const float4 v = *reinterpret_cast<const float4*>(from);
    return {v.x, v.y, v.z, v.w};
  }
#endif
  const Two<Real> low = load_two(from), high = load_two(from + 2);
  return {low.a, low.b, high.a, high.b};
}

// Of a number and a NaN the number `b`; one instruction each.
CUBOCT_HD inline float larger(float a, float b) {
#ifdef __CUDA_ARCH__
  return fmaxf(a, b);
#else
  return a > b ? a : b;
#endif
}
CUBOCT_HD inline double larger(double a, double b) { return a > b ? a : b; }
CUBOCT_HD inline float smaller(float a, float b) {
#ifdef __CUDA_ARCH__
  return fminf(a, b);
#else
  return a < b ? a : b;
#endif
}
CUBOCT_HD inline double smaller(double a, double b) { return a < b ? a : b; }

}  // namespace detail

// The piece of a law that holds r2, core2 <= r2 <= 1. Joints and r2 are rounded: beside a joint the answer
// may be the neighbour, which there has the same force but for rounding.
template <bool kCrowded, class Real>
CUBOCT_HD int piece_of(const RealLaw<Real>& law, const Real* cache, Real r2) {
  const detail::Two<Real> bin = detail::load_two(cache + law.bin_at + 2 * bin_bits(r2, law.bin_shift));
  int piece = index_in(bin.b) + (r2 >= bin.a ? 1 : 0);
  if constexpr (kCrowded)
    while (r2 >= cache[law.joint_at + piece + 1]) ++piece;
  return piece;
}

// f/r in kicks per cutoff at core2 <= r2 <= 1, and 1/r2, for the damping term. The rounding errors of each
// kind are bounded in tests/gpu/real_rule_tests.cpp. `cache`: where the law's coefficients begin.
template <LawKind kKind, class Roots, class Real>
CUBOCT_HD Real over_r(const RealLaw<Real>& law, const Real* cache, Real r2, Real& inverse_r2) {
  if constexpr (!has_pieces(kKind)) {
    // Not the square of 1/r, whose error the power 14 would double.
    const Real q = inverse_r2 = Roots::inverse(r2);
    const Real q3 = q * q * q;
    const Real k = q * q3 * (law.repulsion * q3 - law.attraction);
    if constexpr (kKind == LawKind::lennard_jones) return k;
    return k + law.offset * Roots::inverse_root(r2);
  } else {
    const Real inverse_r = Roots::inverse_root(r2);
    inverse_r2 = inverse_r * inverse_r;
    const int piece = piece_of<is_crowded(kKind)>(law, cache, r2);
    const detail::Four<Real> c = detail::load_four(cache + 4 * piece);
    const Real t = r2 * inverse_r - cache[law.begin_at + piece];
    if constexpr (!is_arc(kKind)) {
      return (c.a + t * (c.b + t * (c.c + t * c.d))) * inverse_r;
    } else {
      // An arc of model/contract/law_form.h has r2 s^2 + r1 s = t; the root that does not cancel is s = 2/r1
      // * p with p = t/(1 + sqrt(z)), z = 1 + 4 r2/r1^2 t = ((dr/ds)/r1)^2. f is a square function of p too:
      // c = {f0, 2 f1/r1, 4 f2/r1^2, 4 r2/r1^2}. Where legs of the control polygon differ much in length, an
      // arc bends within less than a rounding of r: it must not be followed below its beginning, nor z to 0.
      const Real from = detail::larger(t, Real(0));
      const Real z = detail::larger(1 + c.d * from, Real(0x1p-60));
      const Real p = from * Roots::inverse(1 + z * Roots::inverse_root(z));
      return (c.a + p * (c.b + p * c.c)) * inverse_r;
    }
  }
}

// f/r of a law of any kind but several, 0 from its cutoff on. Lanes of unlike kinds go one after another.
template <class Roots, class Real>
CUBOCT_HD Real over_r_of_any(const RealLaw<Real>& law, const Real* cache, Real r2) {
  if (!(r2 < law.cutoff2)) return Real(0);
  const Real* const own = cache + law.first;
  const Real near2 = detail::larger(r2, law.core2);
  Real inverse2;
  switch (law.kind) {
    case LawKind::shifted_lennard_jones:
      return over_r<LawKind::shifted_lennard_jones, Roots>(law, own, near2, inverse2);
    case LawKind::cubic:
      return over_r<LawKind::cubic, Roots>(law, own, near2, inverse2);
    case LawKind::arc:
      return over_r<LawKind::arc, Roots>(law, own, near2, inverse2);
    case LawKind::crowded_cubic:
      return over_r<LawKind::crowded_cubic, Roots>(law, own, near2, inverse2);
    case LawKind::crowded_arc:
      return over_r<LawKind::crowded_arc, Roots>(law, own, near2, inverse2);
    case LawKind::lennard_jones:
    case LawKind::several:
      break;
  }
  return over_r<LawKind::lennard_jones, Roots>(law, own, near2, inverse2);
}

// What j does to i is -factor d (cutoffs per step); tells whether j is inside the cutoff; d = x_j - x_i, in a
// periodic box the shortest, w = v_j - v_i (read only where kDamped), `cache`: rule.cache or a copy of it
// (shared memory). Types are read only where kScaled. Of i and j swapped, with -d and -w, it is the negative
// to the last bit: only even functions of d and w enter the factor. No lane goes an own way, but in crowded
// laws and with several.
template <LawKind kKind, bool kDamped, bool kScaled, class Roots = FastRoots, class Real>
CUBOCT_HD bool pair_factor(const RealRule<Real>& rule, const Real* cache, const Real d[3], const Real w[3],
                           int type_i, int type_j, Real& factor) {
  const Real r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  bool inside = r2 < Real(1);
  // Up to the cutoff, as bins end there.
  Real near2 = detail::larger(r2, rule.core2);
  if constexpr (has_pieces(kKind)) near2 = detail::smaller(near2, Real(1));
  Real inverse2, k;
  if constexpr (kKind == LawKind::several) {
    const int number = rule.type_count * (rule.type_count + type_i) + type_j;
    k = over_r_of_any<Roots>(rule.laws[static_cast<int>(rule.strength[number])], cache, r2);
    if constexpr (kDamped) inverse2 = Roots::inverse(near2);
  } else {
    k = over_r<kKind, Roots>(rule, cache, near2, inverse2);
  }
  if constexpr (kDamped) {
    const Real closing = w[0] * d[0] + w[1] * d[1] + w[2] * d[2];
    const Real rest = 1 - near2;
    k -= rule.damping * rest * rest * inverse2 * closing;
  }
  if constexpr (kScaled) {
    const Real strength = rule.strength[type_i * rule.type_count + type_j];
    inside = inside && (strength > 0 || r2 < rule.contact2);
    k *= strength > 0 ? strength : -strength;
  }
  factor = inside ? k : Real(0);
  return inside;
}
template <class Real>
CUBOCT_HD void add_kick(Real factor, const Real d[3], Real sum[3]) {
  for (int a = 0; a < 3; ++a) sum[a] -= factor * d[a];
}

// What a step adds to v[axis] of a particle whose axis is not imposed; u is read only where its type has PD.
template <class Real>
CUBOCT_HD Real velocity_gain(const RealType<Real>& type, Real sum, Real v, const Real u[3], int axis) {
  Real gain = type.weight * sum + type.gravity[axis];
  if (type.pd) gain -= type.kp * u[axis] + type.kd * (v - type.velocity[axis]);
  return gain;
}

// Kick, constraints and drift of one particle: sum of the pair kicks, x and u in cutoffs, v in cutoffs per
// step. `u` may be null unless rule.pd.
template <class Real>
CUBOCT_HD void finish(const RealRule<Real>& rule, const Real sum[3], Real x[3], Real v[3], Real u[3],
                      int type) {
  if (!rule.constrained) {
    for (int a = 0; a < 3; ++a) {
      v[a] += sum[a];
      x[a] += v[a];
    }
    return;
  }
  const RealType<Real>& of = rule.types[type];
  for (int a = 0; a < 3; ++a) {
    v[a] = of.imposed[a] ? of.velocity[a] : v[a] + velocity_gain(of, sum[a], v[a], u, a);
    if (of.pd) u[a] += v[a] - of.velocity[a];
    x[a] += v[a];
  }
}

// Calls on.template operator()<kind, damped, scaled>() with the rule's own.
template <class Real, class On>
decltype(auto) with_kinds(const RealRule<Real>& rule, On&& on) {
  const auto of = [&]<LawKind kKind>() -> decltype(auto) {
    if (rule.damped && rule.scaled) return on.template operator()<kKind, true, true>();
    if (rule.damped) return on.template operator()<kKind, true, false>();
    if (rule.scaled) return on.template operator()<kKind, false, true>();
    return on.template operator()<kKind, false, false>();
  };
  switch (rule.kind) {
    case LawKind::shifted_lennard_jones:
      return of.template operator()<LawKind::shifted_lennard_jones>();
    case LawKind::cubic:
      return of.template operator()<LawKind::cubic>();
    case LawKind::arc:
      return of.template operator()<LawKind::arc>();
    case LawKind::crowded_cubic:
      return of.template operator()<LawKind::crowded_cubic>();
    case LawKind::crowded_arc:
      return of.template operator()<LawKind::crowded_arc>();
    case LawKind::several:
      if (rule.damped) return on.template operator()<LawKind::several, true, true>();
      return on.template operator()<LawKind::several, false, true>();
    case LawKind::lennard_jones:
      break;
  }
  return of.template operator()<LawKind::lennard_jones>();
}

}  // namespace cuboct::gpu
