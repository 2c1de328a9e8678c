// SPDX-License-Identifier: MIT
// Compiled once per instruction set. Products and sums are rounded apart, so that all give the same bits.
#include "model/pair_kernel.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/pair_kernel.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class Real>
struct Vectors {
  using D = hn::ScalableTag<Real>;
  using V = hn::Vec<D>;
  using M = hn::Mask<D>;
  using I = hn::RebindToSigned<D>;
  using Index = hn::Vec<I>;

  static HWY_INLINE V set(Real value) { return hn::Set(D(), value); }
  static HWY_INLINE Index entries(const uint32_t* at) {
    const hn::Rebind<int32_t, D> narrow;
    const auto index = hn::LoadU(narrow, reinterpret_cast<const int32_t*>(at));
    if constexpr (sizeof(Real) == 4)
      return index;
    else
      return hn::PromoteTo(I(), index);
  }
};

// f/r at a distance whose square, at least the core's, is r2.
template <class Real>
struct LennardJones : Vectors<Real> {
  using typename Vectors<Real>::V;
  using Vectors<Real>::set;
  V sigma2, epsilon24, offset, one;
  bool shifted;
  HWY_INLINE explicit LennardJones(const PairForce<Real>& force)
      : sigma2(set(force.sigma2)),
        epsilon24(set(force.epsilon24)),
        offset(set(force.offset)),
        one(set(1)),
        shifted(force.offset != 0) {}
  HWY_INLINE V over_r(V r2) const {
    const V inverse = hn::Div(one, r2);
    const V q = hn::Mul(sigma2, inverse);
    const V sixth = hn::Mul(hn::Mul(q, q), q);
    const V k = hn::Mul(hn::Mul(epsilon24, inverse), hn::Mul(sixth, hn::Sub(hn::Add(sixth, sixth), one)));
    return shifted ? hn::Add(k, hn::Div(offset, hn::Sqrt(r2))) : k;
  }
};

// Pieces: which one, and its coefficients.
template <class Real>
struct Pieces : Vectors<Real> {
  using typename Vectors<Real>::D;
  using typename Vectors<Real>::V;
  using typename Vectors<Real>::I;
  using typename Vectors<Real>::Index;
  using Vectors<Real>::set;
  const PairForce<Real>& force;
  bool small;  // a vector holds a coefficient of all pieces
  HWY_INLINE explicit Pieces(const PairForce<Real>& force) : force(force), small(force.pieces <= hn::Lanes(D())) {}
  HWY_INLINE Index piece(V r) const {
    const I i;
    const Index one = hn::Set(i, 1);
    Index count = hn::Zero(i);
    for (size_t k = 1; k < force.pieces; ++k) {
      const auto beyond = hn::RebindMask(i, hn::Ge(r, set(force.coefficient[0][k])));
      count = hn::Add(count, hn::IfThenElseZero(beyond, one));
    }
    return count;
  }
  HWY_INLINE V coefficient(size_t of, Index piece) const {
    const Real* table = force.coefficient[of].data();
    if (HWY_LIKELY(small))
      return hn::TableLookupLanes(hn::LoadU(D(), table), hn::IndicesFromVec(D(), piece));
    return hn::GatherIndex(D(), table, piece);
  }
};

template <class Real>
struct Cubic : Pieces<Real> {
  using typename Pieces<Real>::V;
  HWY_INLINE explicit Cubic(const PairForce<Real>& force) : Pieces<Real>(force) {}
  HWY_INLINE V over_r(V r2) const {
    const V r = hn::Sqrt(r2);
    const auto k = this->piece(r);
    const V t = hn::Sub(r, this->coefficient(0, k));
    V f = hn::Add(this->coefficient(3, k), hn::Mul(t, this->coefficient(4, k)));
    f = hn::Add(this->coefficient(2, k), hn::Mul(t, f));
    f = hn::Add(this->coefficient(1, k), hn::Mul(t, f));
    return hn::Div(f, r);
  }
};

// t is the root in [0, 1] of r2 t^2 + r1 t = distance - r, in the form that does not cancel (r1 > 0).
template <class Real>
struct Arc : Pieces<Real> {
  using typename Pieces<Real>::D;
  using typename Pieces<Real>::V;
  HWY_INLINE explicit Arc(const PairForce<Real>& force) : Pieces<Real>(force) {}
  HWY_INLINE V over_r(V r2) const {
    const V r = hn::Sqrt(r2);
    const auto k = this->piece(r);
    const V a = this->coefficient(2, k), b = this->coefficient(1, k), c = hn::Sub(r, this->coefficient(0, k));
    const V ac = hn::Mul(hn::Mul(a, c), this->set(4));
    const V root = hn::Sqrt(hn::Max(hn::Zero(D()), hn::Add(hn::Mul(b, b), ac)));
    const V t = hn::Div(hn::Add(c, c), hn::Add(b, root));
    V f = hn::Add(this->coefficient(4, k), hn::Mul(t, this->coefficient(5, k)));
    f = hn::Add(this->coefficient(3, k), hn::Mul(t, f));
    return hn::Div(f, r);
  }
};

template <class Real>
struct Asked : Vectors<Real> {
  using typename Vectors<Real>::D;
  using typename Vectors<Real>::V;
  const PairLaw& law;
  HWY_INLINE explicit Asked(const PairForce<Real>& force) : law(*force.law) {}
  HWY_INLINE V over_r(V r2) const {
    Real at[hn::MaxLanes(D())];
    hn::StoreU(hn::Sqrt(r2), D(), at);
    for (Real& r : at) r = static_cast<Real>(law.force(static_cast<double>(r)) / static_cast<double>(r));
    return hn::LoadU(D(), at);
  }
};

template <bool kDamped, class Real, class Law>
HWY_INLINE void sum_forces(const PairForce<Real>& force, const PairRows& rows, const Real* x, const Real* v,
                           Real* f) {
  using Vs = Vectors<Real>;
  using V = typename Vs::V;
  using Index = typename Vs::Index;
  const typename Vs::D d;
  const typename Vs::I ii;
  const size_t lanes = hn::Lanes(d);
  const Law law(force);
  const V cutoff2 = hn::Set(d, force.cutoff2), core2 = hn::Set(d, force.core2), zero = hn::Zero(d);
  const V damping = hn::Set(d, force.damping), inverse_cutoff2 = hn::Set(d, force.inverse_cutoff2);
  const V one = hn::Set(d, Real{1});
  const bool ring = force.ring, scaled = !force.strength.empty();
  const Index own_lanes = hn::ShiftLeft<2>(hn::Iota(ii, 0));
  for (size_t g = 0; g + 1 < rows.begin.size(); ++g) {
    const size_t slot = (rows.first_group + g) * lanes;
    const Real* const home = x + 4 * slot;
    const V x0 = hn::GatherIndex(d, home, own_lanes), x1 = hn::GatherIndex(d, home + 1, own_lanes),
            x2 = hn::GatherIndex(d, home + 2, own_lanes);
    V v0 = zero, v1 = zero, v2 = zero;
    if (kDamped) {
      v0 = hn::GatherIndex(d, v + 4 * slot, own_lanes);
      v1 = hn::GatherIndex(d, v + 4 * slot + 1, own_lanes);
      v2 = hn::GatherIndex(d, v + 4 * slot + 2, own_lanes);
    }
    V row_of_strengths = zero;
    if (scaled)
      row_of_strengths = hn::Mul(hn::GatherIndex(d, home + 3, own_lanes),
                                 hn::Set(d, static_cast<Real>(force.materials)));
    V f0 = zero, f1 = zero, f2 = zero;
    const uint32_t* const end = rows.entry.data() + rows.begin[g + 1] * lanes;
    for (const uint32_t* at = rows.entry.data() + rows.begin[g] * lanes; at < end; at += lanes) {
      const Index j = Vs::entries(at);
      V d0 = hn::Sub(hn::GatherIndex(d, x, j), x0), d1 = hn::Sub(hn::GatherIndex(d, x + 1, j), x1),
        d2 = hn::Sub(hn::GatherIndex(d, x + 2, j), x2);
      if (ring) {
        const auto nearest = [&](V difference, int axis) HWY_ATTR {
          const V turns = hn::Round(hn::Mul(difference, hn::Set(d, force.inverse_extent[axis])));
          return hn::Sub(difference, hn::Mul(turns, hn::Set(d, force.extent[axis])));
        };
        d0 = nearest(d0, 0);
        d1 = nearest(d1, 1);
        d2 = nearest(d2, 2);
      }
      const V r2 = hn::Add(hn::Add(hn::Mul(d0, d0), hn::Mul(d1, d1)), hn::Mul(d2, d2));
      // Particles at one point have no direction to push each other.
      const auto pair = hn::And(hn::Lt(r2, cutoff2), hn::Gt(r2, zero));
      const V near2 = hn::Max(r2, core2);
      V k = law.over_r(near2);
      if (kDamped) {
        const V w0 = hn::Sub(hn::GatherIndex(d, v, j), v0), w1 = hn::Sub(hn::GatherIndex(d, v + 1, j), v1),
                w2 = hn::Sub(hn::GatherIndex(d, v + 2, j), v2);
        const V closing = hn::Add(hn::Add(hn::Mul(w0, d0), hn::Mul(w1, d1)), hn::Mul(w2, d2));
        const V rest = hn::Sub(one, hn::Mul(near2, inverse_cutoff2));
        const V c = hn::Div(hn::Mul(damping, hn::Mul(rest, rest)), near2);
        k = hn::Sub(k, hn::Mul(c, closing));
      }
      if (scaled) {
        const V which = hn::Add(row_of_strengths, hn::GatherIndex(d, x + 3, j));
        k = hn::Mul(k, hn::GatherIndex(d, force.strength.data(), hn::ConvertTo(ii, which)));
      }
      k = hn::IfThenElseZero(pair, k);
      f0 = hn::Sub(f0, hn::Mul(k, d0));
      f1 = hn::Sub(f1, hn::Mul(k, d1));
      f2 = hn::Sub(f2, hn::Mul(k, d2));
    }
    Real* const out = f + 4 * slot;
    hn::ScatterIndex(f0, d, out, own_lanes);
    hn::ScatterIndex(f1, d, out + 1, own_lanes);
    hn::ScatterIndex(f2, d, out + 2, own_lanes);
  }
}

template <class Real>
void forces_of(const PairForce<Real>& force, const PairRows& rows, const Real* x, const Real* v, Real* f) {
  using Kind = typename PairForce<Real>::Kind;
  const bool damped = force.damping > 0;
  const auto by = [&]<class Law>() HWY_ATTR {
    if (damped)
      sum_forces<true, Real, Law>(force, rows, x, v, f);
    else
      sum_forces<false, Real, Law>(force, rows, x, v, f);
  };
  switch (force.kind) {
    case Kind::lennard_jones: return by.template operator()<LennardJones<Real>>();
    case Kind::cubic: return by.template operator()<Cubic<Real>>();
    case Kind::arc: return by.template operator()<Arc<Real>>();
    case Kind::asked: return by.template operator()<Asked<Real>>();
  }
}
void forces64(const PairForce<double>& force, const PairRows& rows, const double* x, const double* v, double* f) {
  forces_of(force, rows, x, v, f);
}
void forces32(const PairForce<float>& force, const PairRows& rows, const float* x, const float* v, float* f) {
  forces_of(force, rows, x, v, f);
}
size_t lanes64() { return hn::Lanes(hn::ScalableTag<double>()); }
size_t lanes32() { return hn::Lanes(hn::ScalableTag<float>()); }
const char* simd() { return hwy::TargetName(HWY_TARGET); }

}  // namespace cuboct::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct {

HWY_EXPORT(forces64);
HWY_EXPORT(forces32);
HWY_EXPORT(lanes64);
HWY_EXPORT(lanes32);
HWY_EXPORT(simd);

void pair_forces(const PairForce<double>& force, const PairRows& rows, const double* x, const double* v, double* f) {
  HWY_DYNAMIC_DISPATCH(forces64)(force, rows, x, v, f);
}
void pair_forces(const PairForce<float>& force, const PairRows& rows, const float* x, const float* v, float* f) {
  HWY_DYNAMIC_DISPATCH(forces32)(force, rows, x, v, f);
}
template <>
size_t pair_lanes<double>() {
  return HWY_DYNAMIC_DISPATCH(lanes64)();
}
template <>
size_t pair_lanes<float>() {
  return HWY_DYNAMIC_DISPATCH(lanes32)();
}
const char* pair_simd() { return HWY_DYNAMIC_DISPATCH(simd)(); }

template <class Real>
PairForce<Real>::PairForce(const Rule& rule, const Periodic& periodic) : law(rule.law.get()) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  const auto take = [&](const auto& list, auto... member) {
    pieces = list.size();
    for (size_t k = 0; k < std::max(pieces, kLeastPieces); ++k) {
      const auto& piece = list[std::min(k, pieces - 1)];
      size_t c = 0;
      (coefficient[c++].push_back(real(piece.*member)), ...);
    }
  };
  const LawForm form = law->form();
  if (const auto* lj = std::get_if<LennardJonesForm>(&form)) {
    kind = Kind::lennard_jones;
    sigma2 = real(lj->sigma * lj->sigma);
    epsilon24 = real(24 * lj->epsilon);
    offset = real(lj->offset);
  } else if (const auto* cubics = std::get_if<std::vector<CubicPiece>>(&form)) {
    kind = Kind::cubic;
    take(*cubics, &CubicPiece::r, &CubicPiece::c0, &CubicPiece::c1, &CubicPiece::c2, &CubicPiece::c3);
  } else if (const auto* arcs = std::get_if<std::vector<ArcPiece>>(&form)) {
    kind = Kind::arc;
    take(*arcs, &ArcPiece::r, &ArcPiece::r1, &ArcPiece::r2, &ArcPiece::f0, &ArcPiece::f1, &ArcPiece::f2);
  }
  const double cutoff = law->cutoff(), core = law->core();
  cutoff2 = real(cutoff * cutoff);
  core2 = real(core * core);
  damping = real(rule.damping.coefficient);
  inverse_cutoff2 = real(1 / (cutoff * cutoff));
  bool scaled = false;
  for (const auto& row : rule.strength)
    for (const double factor : row) scaled |= factor != 1;
  if (scaled) {
    materials = rule.strength.size();
    for (const auto& row : rule.strength)
      for (const double factor : row) strength.push_back(real(factor));
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (periodic.extent[axis] <= 0) continue;
    ring = true;
    extent[axis] = real(periodic.extent[axis]);
    inverse_extent[axis] = real(1 / periodic.extent[axis]);
  }
}
template struct PairForce<double>;
template struct PairForce<float>;

}  // namespace cuboct
#endif
