// SPDX-License-Identifier: MIT
// Compiled once per instruction set.
#include "model/atoms/bond_order/tersoff_kernel.h"

#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/atoms/bond_order/tersoff_kernel.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After highway.h, once per instruction set.
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
using I = hn::RebindToSigned<D>;

HWY_INLINE V set(double value) { return hn::Set(D(), value); }

// The first three numbers of the records at entries `at`. Where a vector has 512 bits, whole records are
// loaded and transposed, which takes half the time of gathers.
HWY_INLINE void load_records(const double* from, const uint32_t* at, V out[3]) {
#if HWY_TARGET == HWY_AVX3
  const auto two = [&](int low, int high) HWY_ATTR {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(from + at[low])),
                              _mm256_loadu_pd(from + at[high]), 1);
  };
  const __m512d ab = two(0, 2), cd = two(1, 3), ef = two(4, 6), gh = two(5, 7);
  const __m512d low0 = _mm512_unpacklo_pd(ab, cd), low1 = _mm512_unpacklo_pd(ef, gh);  // x x z z
  const __m512d high0 = _mm512_unpackhi_pd(ab, cd), high1 = _mm512_unpackhi_pd(ef, gh);
  out[0] = V{_mm512_shuffle_f64x2(low0, low1, 0x88)};
  out[1] = V{_mm512_shuffle_f64x2(high0, high1, 0x88)};
  out[2] = V{_mm512_shuffle_f64x2(low0, low1, 0xdd)};
#else
  const hn::Rebind<int32_t, D> narrow;
  const auto index = hn::PromoteTo(I(), hn::LoadU(narrow, reinterpret_cast<const int32_t*>(at)));
  for (int axis = 0; axis < 3; ++axis) out[axis] = hn::GatherIndex(D(), from + axis, index);
#endif
}

// The constants of tersoff_terms.h in vectors.
struct Term {
  explicit HWY_INLINE Term(const TersoffTerm<double>& t)
      : cutoff2(set((t.R + t.D) * (t.R + t.D))),
        R(set(t.R)),
        whole(set(t.R - t.D)),
        turn(set(std::numbers::pi / 2 / t.D)),
        half_turn(set(-std::numbers::pi / 4 / t.D)),
        d2(set(t.d * t.d)),
        cos_theta0(set(t.cos_theta0)),
        gamma(set(t.gamma)),
        gain(set(t.gamma * t.c * t.c)),
        gain_over_d2(set(t.gamma * t.c * t.c / (t.d * t.d))),
        n(set(t.n)),
        beta(set(t.beta)),
        minus_half_n(set(-0.5 / t.n)),
        lambda1(set(t.lambda1)),
        lambda2(set(t.lambda2)),
        lambda3(set(t.lambda3)),
        A(set(t.A)),
        B(set(t.B)),
        cubic(t.m == 3) {}
  V cutoff2, R, whole, turn, half_turn, d2, cos_theta0, gamma, gain, gain_over_d2, n, beta, minus_half_n,
      lambda1, lambda2, lambda3, A, B;
  bool cubic;
};

// Of an atom's neighbour, in scratch.
enum Of : size_t { ex, ey, ez, rr, inverse_r, fc, fc_slope, zeta, p, radial, tx, ty, tz, kOfBond };
// Of two neighbours: the cosine between them, g and its slope; the two stretches and what their slopes are
// over them.
enum OfPair : size_t { cosine, g, g_slope, stretch_jk, over_jk, stretch_kj, over_kj, kOfPair };

struct Scratch {
  double* at;
  size_t lanes = hn::Lanes(D());
  HWY_INLINE V get(size_t block) const { return hn::Load(D(), at + block * lanes); }
  HWY_INLINE void put(size_t block, V value) const { hn::Store(value, D(), at + block * lanes); }
};

// fc and its slope; only where some lane is between R - D and R + D are sines asked for.
HWY_INLINE void cutoff(const Term& t, M near, V r, V& value, V& slope) {
  const D d;
  const M falls = hn::And(near, hn::Ge(r, t.whole));
  value = hn::IfThenElseZero(near, set(1)), slope = hn::Zero(d);
  if (HWY_LIKELY(hn::AllFalse(d, falls))) return;
  const V angle = hn::Mul(t.turn, hn::Sub(r, t.R));
  const V inside = hn::IfThenElseZero(falls, angle);
  value = hn::IfThenElse(falls, hn::Mul(set(0.5), hn::Sub(set(1), hn::Sin(d, inside))), value);
  slope = hn::IfThenElseZero(falls, hn::Mul(t.half_turn, hn::Cos(d, inside)));
}

HWY_INLINE void stretch(const Term& t, V x, V& value, V& slope_over) {
  const D d;
  const V y = hn::Mul(t.lambda3, x);
  const V power = t.cubic ? hn::Mul(hn::Mul(y, y), y) : y;
  slope_over = t.cubic ? hn::Mul(set(3), hn::Mul(t.lambda3, hn::Mul(y, y))) : t.lambda3;
  const V most = set(69.0776);
  const M above = hn::Gt(power, most), below = hn::Lt(power, hn::Neg(most));
  value = hn::Exp(d, hn::Min(hn::Max(power, hn::Neg(most)), most));
  if (HWY_LIKELY(hn::AllFalse(d, hn::Or(above, below)))) return;
  value = hn::IfThenElse(above, set(1e30), hn::IfThenZeroElse(below, value));
  slope_over = hn::IfThenZeroElse(hn::Or(above, below), slope_over);
}

// b and db/dzeta, as in tersoff_order.
HWY_INLINE void order(const Term& t, V zeta, V& b, V& slope) {
  const D d;
  const V one = set(1), x = hn::Mul(t.beta, zeta);
  const M some = hn::Gt(x, set(1e-300));
  const V u = hn::Mul(t.n, hn::Log(d, hn::IfThenElse(some, x, one)));
  const V e = hn::Exp(d, hn::Max(hn::Neg(hn::Abs(u)), set(-700)));
  const V sum = hn::Add(one, e);
  const M large = hn::Gt(u, hn::Zero(d));
  const V logarithm = hn::Add(hn::Max(u, hn::Zero(d)), hn::Log(d, sum));
  b = hn::Exp(d, hn::Mul(t.minus_half_n, logarithm));
  const V share = hn::Div(hn::IfThenElse(large, one, e), hn::Mul(sum, hn::IfThenElse(some, zeta, one)));
  b = hn::IfThenElse(some, b, one);
  slope = hn::IfThenElseZero(some, hn::Mul(hn::Mul(set(-0.5), b), share));
}

template <bool kStretched, bool kSums>
HWY_INLINE void partials(const Term& t, const TersoffSweep& sweep, size_t first, size_t last,
                         double* memory) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const BondList& list = *sweep.list;
  const uint32_t* const first_row = list.first_row().data();
  const V zero = hn::Zero(d), one = set(1), half = set(0.5);
  for (size_t group = first; group < last; ++group) {
    const size_t begin = first_row[group], end = first_row[group + 1];
    const Scratch bond{memory}, pair{memory + (end - begin) * (kOfBond + 1) * lanes};
    double* const rows = memory + (end - begin) * kOfBond * lanes;  // which row an active bond stands in
    V home[3], unused;
    hn::LoadInterleaved4(d, sweep.x + 4 * group * lanes, home[0], home[1], home[2], unused);

    // Neighbours within the cutoff of some lane.
    size_t active = 0;
    for (size_t row = begin; row < end; ++row) {
      V at[3];
      load_records(sweep.x, list.entry().data() + row * lanes, at);
      const V x = hn::Sub(at[0], home[0]), y = hn::Sub(at[1], home[1]), z = hn::Sub(at[2], home[2]);
      const V r2 = hn::MulAdd(z, z, hn::MulAdd(y, y, hn::Mul(x, x)));
      const M near = hn::And(hn::Lt(r2, t.cutoff2), hn::Gt(r2, zero));
      if (hn::AllFalse(d, near)) {
        hn::StoreInterleaved4(zero, zero, zero, zero, d, sweep.partial + 4 * row * lanes);
        continue;
      }
      const V r = hn::Sqrt(hn::IfThenElse(near, r2, t.cutoff2));
      const V over = hn::Div(one, r), unit = hn::IfThenElseZero(near, over);
      V value, slope;
      cutoff(t, near, r, value, slope);
      const size_t k = active++ * kOfBond;
      bond.put(k + ex, hn::Mul(x, unit));
      bond.put(k + ey, hn::Mul(y, unit));
      bond.put(k + ez, hn::Mul(z, unit));
      bond.put(k + rr, r);
      bond.put(k + inverse_r, over);
      bond.put(k + fc, value);
      bond.put(k + fc_slope, slope);
      bond.put(k + zeta, zero);
      bond.put(k + tx, zero);
      bond.put(k + ty, zero);
      bond.put(k + tz, zero);
      rows[k / kOfBond] = static_cast<double>(row);
    }

    // Pairs of them: what each adds to the other's zeta.
    size_t n = 0;
    for (size_t j = 0; j < active * kOfBond; j += kOfBond) {
      const V jx = bond.get(j + ex), jy = bond.get(j + ey), jz = bond.get(j + ez), jr = bond.get(j + rr),
              jf = bond.get(j + fc);
      V sum = bond.get(j + zeta);
      for (size_t k = j + kOfBond; k < active * kOfBond; k += kOfBond, n += kOfPair) {
        const V c =
            hn::MulAdd(jz, bond.get(k + ez), hn::MulAdd(jy, bond.get(k + ey), hn::Mul(jx, bond.get(k + ex))));
        const V u = hn::Sub(c, t.cos_theta0), u2 = hn::Mul(u, u);
        const V over = hn::Div(one, hn::Add(t.d2, u2));
        const V value = hn::MulAdd(hn::Mul(t.gain_over_d2, u2), over, t.gamma);
        const V slope = hn::Mul(hn::Mul(hn::Add(u, u), t.gain), hn::Mul(over, over));
        pair.put(n + cosine, c);
        pair.put(n + g, value);
        pair.put(n + g_slope, slope);
        V to_j = hn::Mul(bond.get(k + fc), value), to_k = hn::Mul(jf, value);
        if constexpr (kStretched) {
          V forth, forth_over, back, back_over;
          const V x = hn::Sub(jr, bond.get(k + rr));
          stretch(t, x, forth, forth_over);
          stretch(t, hn::Neg(x), back, back_over);
          to_j = hn::Mul(to_j, forth), to_k = hn::Mul(to_k, back);
          pair.put(n + stretch_jk, forth);
          pair.put(n + over_jk, forth_over);
          pair.put(n + stretch_kj, back);
          pair.put(n + over_kj, back_over);
        }
        sum = hn::Add(sum, to_j);
        bond.put(k + zeta, hn::Add(bond.get(k + zeta), to_k));
      }
      bond.put(j + zeta, sum);
    }

    // Bonds: their orders, p = dE_i/dzeta, and dE_i/dr at fixed zeta.
    V energy = zero;
    for (size_t j = 0; j < active * kOfBond; j += kOfBond) {
      const V r = bond.get(j + rr), f = bond.get(j + fc);
      const V repulsion = hn::Mul(t.A, hn::Exp(d, hn::Neg(hn::Mul(t.lambda1, r))));
      const V attraction = hn::Mul(t.B, hn::Exp(d, hn::Neg(hn::Mul(t.lambda2, r))));
      V b, b_slope;
      order(t, bond.get(j + zeta), b, b_slope);
      const V bound = hn::Mul(b, attraction), depth = hn::Sub(repulsion, bound);
      const V steep = hn::Sub(hn::Mul(t.lambda2, bound), hn::Mul(t.lambda1, repulsion));
      bond.put(j + p, hn::Neg(hn::Mul(hn::Mul(half, f), hn::Mul(attraction, b_slope))));
      bond.put(j + radial, hn::Mul(half, hn::MulAdd(bond.get(j + fc_slope), depth, hn::Mul(f, steep))));
      if constexpr (kSums) energy = hn::MulAdd(hn::Mul(half, f), depth, energy);
    }

    // Pairs again: how zeta moves with both distances and the cosine, dcos/dd_j = (e_k - cos e_j)/r_j.
    n = 0;
    for (size_t j = 0; j < active * kOfBond; j += kOfBond) {
      const V jp = bond.get(j + p), jf = bond.get(j + fc), js = bond.get(j + fc_slope),
              jo = bond.get(j + inverse_r);
      const V jx = bond.get(j + ex), jy = bond.get(j + ey), jz = bond.get(j + ez);
      V jradial = bond.get(j + radial), sx = bond.get(j + tx), sy = bond.get(j + ty), sz = bond.get(j + tz);
      for (size_t k = j + kOfBond; k < active * kOfBond; k += kOfBond, n += kOfPair) {
        const V value = pair.get(n + g), c = pair.get(n + cosine);
        V to_j = jp, to_k = bond.get(k + p);
        if constexpr (kStretched)
          to_j = hn::Mul(to_j, pair.get(n + stretch_jk)), to_k = hn::Mul(to_k, pair.get(n + stretch_kj));
        const V k_share = hn::Mul(to_j, bond.get(k + fc)), j_share = hn::Mul(to_k, jf);
        const V turning = hn::Mul(hn::Add(k_share, j_share), pair.get(n + g_slope));
        V on_j = hn::Mul(to_k, js), on_k = hn::Mul(to_j, bond.get(k + fc_slope));
        if constexpr (kStretched) {
          const V pull =
              hn::Sub(hn::Mul(k_share, pair.get(n + over_jk)), hn::Mul(j_share, pair.get(n + over_kj)));
          on_j = hn::Add(on_j, pull), on_k = hn::Sub(on_k, pull);
        }
        const V on_cos_j = hn::Mul(turning, jo), on_cos_k = hn::Mul(turning, bond.get(k + inverse_r));
        jradial = hn::Add(jradial, hn::NegMulAdd(c, on_cos_j, hn::Mul(value, on_j)));
        sx = hn::MulAdd(on_cos_j, bond.get(k + ex), sx);
        sy = hn::MulAdd(on_cos_j, bond.get(k + ey), sy);
        sz = hn::MulAdd(on_cos_j, bond.get(k + ez), sz);
        bond.put(k + radial, hn::Add(bond.get(k + radial), hn::NegMulAdd(c, on_cos_k, hn::Mul(value, on_k))));
        bond.put(k + tx, hn::MulAdd(on_cos_k, jx, bond.get(k + tx)));
        bond.put(k + ty, hn::MulAdd(on_cos_k, jy, bond.get(k + ty)));
        bond.put(k + tz, hn::MulAdd(on_cos_k, jz, bond.get(k + tz)));
      }
      bond.put(j + radial, jradial);
      bond.put(j + tx, sx);
      bond.put(j + ty, sy);
      bond.put(j + tz, sz);
    }

    V force[3] = {zero, zero, zero}, virial[6] = {zero, zero, zero, zero, zero, zero};
    for (size_t j = 0; j < active * kOfBond; j += kOfBond) {
      const V along = bond.get(j + radial), x = bond.get(j + ex), y = bond.get(j + ey), z = bond.get(j + ez);
      const V gx = hn::MulAdd(along, x, bond.get(j + tx)), gy = hn::MulAdd(along, y, bond.get(j + ty)),
              gz = hn::MulAdd(along, z, bond.get(j + tz));
      const auto row = static_cast<size_t>(rows[j / kOfBond]);
      hn::StoreInterleaved4(gx, gy, gz, zero, d, sweep.partial + 4 * row * lanes);
      force[0] = hn::Add(force[0], gx);
      force[1] = hn::Add(force[1], gy);
      force[2] = hn::Add(force[2], gz);
      if constexpr (kSums) {
        const V r = bond.get(j + rr), half_r = hn::Mul(half, r);
        virial[0] = hn::MulAdd(hn::Mul(r, x), gx, virial[0]);
        virial[1] = hn::MulAdd(hn::Mul(r, y), gy, virial[1]);
        virial[2] = hn::MulAdd(hn::Mul(r, z), gz, virial[2]);
        virial[3] = hn::MulAdd(half_r, hn::MulAdd(y, gz, hn::Mul(z, gy)), virial[3]);
        virial[4] = hn::MulAdd(half_r, hn::MulAdd(x, gz, hn::Mul(z, gx)), virial[4]);
        virial[5] = hn::MulAdd(half_r, hn::MulAdd(x, gy, hn::Mul(y, gx)), virial[5]);
      }
    }
    hn::StoreInterleaved4(force[0], force[1], force[2], zero, d, sweep.force + 4 * group * lanes);
    if constexpr (kSums) {
      hn::StoreU(energy, d, sweep.energy + group * lanes);
      for (size_t k = 0; k < 6; ++k) hn::StoreU(virial[k], d, sweep.virial + (group * 6 + k) * lanes);
    }
  }
}

void tersoff_partials(const TersoffTerm<double>& term, const TersoffSweep& sweep, size_t first, size_t last,
                      double* scratch) {
  const Term t(term);
  const bool sums = sweep.energy != nullptr;
  if (term.lambda3 != 0) {
    sums ? partials<true, true>(t, sweep, first, last, scratch)
         : partials<true, false>(t, sweep, first, last, scratch);
  } else {
    sums ? partials<false, true>(t, sweep, first, last, scratch)
         : partials<false, false>(t, sweep, first, last, scratch);
  }
}

void tersoff_collect(const TersoffSweep& sweep, size_t first, size_t last) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  const uint32_t* const first_row = sweep.list->first_row().data();
  for (size_t group = first; group < last; ++group) {
    V force[4];
    double* const own = sweep.force + 4 * group * lanes;
    hn::LoadInterleaved4(d, own, force[0], force[1], force[2], force[3]);
    for (size_t row = first_row[group]; row < first_row[group + 1]; ++row) {
      V other[3];
      load_records(sweep.partial, sweep.list->reverse().data() + row * lanes, other);
      for (int a = 0; a < 3; ++a) force[a] = hn::Sub(force[a], other[a]);
    }
    hn::StoreInterleaved4(force[0], force[1], force[2], force[3], d, own);
  }
}

size_t tersoff_scratch(size_t rows) {
  return (rows * (kOfBond + 1) + rows * (rows - (rows > 0 ? 1 : 0)) / 2 * kOfPair) * hn::Lanes(D());
}
size_t bond_lanes() { return hn::Lanes(D()); }
const char* bond_simd() { return hwy::TargetName(HWY_TARGET); }

}  // namespace cuboct::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct {

HWY_EXPORT(tersoff_partials);
HWY_EXPORT(tersoff_collect);
HWY_EXPORT(tersoff_scratch);
HWY_EXPORT(bond_lanes);
HWY_EXPORT(bond_simd);

void tersoff_partials(const TersoffTerm<double>& term, const TersoffSweep& sweep, size_t first, size_t last,
                      double* scratch) {
  HWY_DYNAMIC_DISPATCH(tersoff_partials)(term, sweep, first, last, scratch);
}
void tersoff_collect(const TersoffSweep& sweep, size_t first, size_t last) {
  HWY_DYNAMIC_DISPATCH(tersoff_collect)(sweep, first, last);
}
size_t tersoff_scratch(size_t rows) { return HWY_DYNAMIC_DISPATCH(tersoff_scratch)(rows); }
size_t bond_lanes() { return HWY_DYNAMIC_DISPATCH(bond_lanes)(); }
const char* bond_simd() { return HWY_DYNAMIC_DISPATCH(bond_simd)(); }

}  // namespace cuboct
#endif
