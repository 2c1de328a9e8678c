// SPDX-License-Identifier: MIT
// Compiled once per instruction set. Products and sums are rounded apart, so that all give the same bits.
#include "model/real/pair_kernel.h"

#include <algorithm>
#include <bit>
#include <type_traits>

#include "model/contract/law_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "model/real/pair_kernel.cpp"
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

// The first three numbers of the records at entries `at`: gathers in general. Where a vector has 512 bits,
// whole records are loaded and transposed, which takes half the time.
#if HWY_TARGET == HWY_AVX3
HWY_INLINE void load_records(const double* from, const uint32_t* at, const Vectors<double>::Index&,
                             Vectors<double>::V out[3]) {
  const auto two = [&](int low, int high) HWY_ATTR {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(from + at[low])),
                              _mm256_loadu_pd(from + at[high]), 1);
  };
  const __m512d ab = two(0, 2), cd = two(1, 3), ef = two(4, 6), gh = two(5, 7);
  const __m512d low0 = _mm512_unpacklo_pd(ab, cd), low1 = _mm512_unpacklo_pd(ef, gh);  // x x z z
  const __m512d high0 = _mm512_unpackhi_pd(ab, cd), high1 = _mm512_unpackhi_pd(ef, gh);
  out[0] = Vectors<double>::V{_mm512_shuffle_f64x2(low0, low1, 0x88)};
  out[1] = Vectors<double>::V{_mm512_shuffle_f64x2(high0, high1, 0x88)};
  out[2] = Vectors<double>::V{_mm512_shuffle_f64x2(low0, low1, 0xdd)};
}
HWY_INLINE void load_records(const float* from, const uint32_t* at, const Vectors<float>::Index&,
                             Vectors<float>::V out[3]) {
  const auto four = [&](int first) HWY_ATTR {
    __m512 of = _mm512_castps128_ps512(_mm_loadu_ps(from + at[first]));
    of = _mm512_insertf32x4(of, _mm_loadu_ps(from + at[first + 4]), 1);
    of = _mm512_insertf32x4(of, _mm_loadu_ps(from + at[first + 8]), 2);
    return _mm512_insertf32x4(of, _mm_loadu_ps(from + at[first + 12]), 3);
  };
  const __m512 a = four(0), b = four(1), c = four(2), d = four(3);
  const __m512d low0 = _mm512_castps_pd(_mm512_unpacklo_ps(a, b)),
                low1 = _mm512_castps_pd(_mm512_unpacklo_ps(c, d));
  const __m512d high0 = _mm512_castps_pd(_mm512_unpackhi_ps(a, b)),
                high1 = _mm512_castps_pd(_mm512_unpackhi_ps(c, d));
  out[0] = Vectors<float>::V{_mm512_castpd_ps(_mm512_unpacklo_pd(low0, low1))};
  out[1] = Vectors<float>::V{_mm512_castpd_ps(_mm512_unpackhi_pd(low0, low1))};
  out[2] = Vectors<float>::V{_mm512_castpd_ps(_mm512_unpacklo_pd(high0, high1))};
}
#else
template <class Real>
HWY_INLINE void load_records(const Real* from, const uint32_t*, const typename Vectors<Real>::Index& at,
                             typename Vectors<Real>::V out[3]) {
  for (int axis = 0; axis < 3; ++axis)
    out[axis] = hn::GatherIndex(typename Vectors<Real>::D(), from + axis, at);
}
#endif

// f/r at a distance whose square, at least the core's, is r2.
template <class Real>
struct LennardJones : Vectors<Real> {
  using typename Vectors<Real>::V;
  using Vectors<Real>::set;
  V sigma2, epsilon24, offset, one;
  bool shifted;
  HWY_INLINE explicit LennardJones(const LawTerms<Real>& terms)
      : sigma2(set(terms.sigma2)),
        epsilon24(set(terms.epsilon24)),
        offset(set(terms.offset)),
        one(set(1)),
        shifted(terms.offset != 0) {}
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
  const LawTerms<Real>& terms;
  bool small;  // a vector holds a coefficient of all pieces
  HWY_INLINE explicit Pieces(const LawTerms<Real>& terms)
      : terms(terms), small(terms.pieces <= hn::Lanes(D())) {}
  // By r^2, which is known before the root. Where rounding picks the neighbour, both agree but for rounding.
  HWY_INLINE Index piece(V r2) const {
    const I i;
    const Index one = hn::Set(i, 1);
    Index count = hn::Zero(i);
    for (size_t k = 0; k + 1 < terms.pieces; ++k) {
      const auto beyond = hn::RebindMask(i, hn::Ge(r2, set(terms.joint2[k])));
      count = hn::Add(count, hn::IfThenElseZero(beyond, one));
    }
    return count;
  }
  HWY_INLINE V coefficient(size_t of, Index piece) const {
    const Real* table = terms.coefficient[of].data();
    if (HWY_LIKELY(small)) return hn::TableLookupLanes(hn::LoadU(D(), table), hn::IndicesFromVec(D(), piece));
    return hn::GatherIndex(D(), table, piece);
  }
};

template <class Real>
struct Cubic : Pieces<Real> {
  using typename Pieces<Real>::V;
  HWY_INLINE explicit Cubic(const LawTerms<Real>& terms) : Pieces<Real>(terms) {}
  HWY_INLINE V over_r(V r2) const {
    const V r = hn::Sqrt(r2);
    const auto k = this->piece(r2);
    const V t = hn::Sub(r, this->coefficient(0, k));
    V f = hn::Add(this->coefficient(3, k), hn::Mul(t, this->coefficient(4, k)));
    f = hn::Add(this->coefficient(2, k), hn::Mul(t, f));
    f = hn::Add(this->coefficient(1, k), hn::Mul(t, f));
    return hn::Mul(hn::Mul(f, r), hn::Div(this->set(1), r2));
  }
};

// t is the root in [0, 1] of r2 t^2 + r1 t = distance - r, in the form that does not cancel (r1 > 0).
template <class Real>
struct Arc : Pieces<Real> {
  using typename Pieces<Real>::D;
  using typename Pieces<Real>::V;
  HWY_INLINE explicit Arc(const LawTerms<Real>& terms) : Pieces<Real>(terms) {}
  HWY_INLINE V over_r(V r2) const {
    const V r = hn::Sqrt(r2);
    const auto k = this->piece(r2);
    const V a = this->coefficient(2, k), b = this->coefficient(1, k), c = hn::Sub(r, this->coefficient(0, k));
    const V ac = hn::Mul(hn::Mul(a, c), this->set(4));
    const V root = hn::Sqrt(hn::Max(hn::Zero(D()), hn::Add(hn::Mul(b, b), ac)));
    const V t = hn::Div(hn::Add(c, c), hn::Add(b, root));
    V f = hn::Add(this->coefficient(4, k), hn::Mul(t, this->coefficient(5, k)));
    f = hn::Add(this->coefficient(3, k), hn::Mul(t, f));
    return hn::Mul(hn::Mul(f, r), hn::Div(this->set(1), r2));
  }
};

template <class Real>
struct Asked : Vectors<Real> {
  using typename Vectors<Real>::D;
  using typename Vectors<Real>::V;
  const PairLaw& law;
  HWY_INLINE explicit Asked(const LawTerms<Real>& terms) : law(*terms.law) {}
  HWY_INLINE V over_r(V r2) const {
    constexpr size_t kLanes = hn::MaxLanes(D());
    Real at[kLanes];
    double r[kLanes], f[kLanes];
    hn::StoreU(hn::Sqrt(r2), D(), at);
    std::copy_n(at, kLanes, r);
    if (!forces_of(law, r, f))
      for (size_t k = 0; k < kLanes; ++k) f[k] = law.force(r[k]);
    for (size_t k = 0; k < kLanes; ++k) at[k] = static_cast<Real>(f[k] / r[k]);
    return hn::LoadU(D(), at);
  }
};

// Of several laws that of each lane's pair, by its number.
template <class Real>
struct Several : Vectors<Real> {
  using typename Vectors<Real>::D;
  using typename Vectors<Real>::V;
  using Vectors<Real>::set;
  const std::vector<LawTerms<Real>>& laws;
  HWY_INLINE explicit Several(const PairForce<Real>& force) : laws(force.laws) {}
  static HWY_INLINE V of_one(const LawTerms<Real>& terms, V near2) {
    using Kind = typename LawTerms<Real>::Kind;
    switch (terms.kind) {
      case Kind::lennard_jones:
        return LennardJones<Real>(terms).over_r(near2);
      case Kind::cubic:
        return Cubic<Real>(terms).over_r(near2);
      case Kind::arc:
        return Arc<Real>(terms).over_r(near2);
      case Kind::asked:
        break;
    }
    return Asked<Real>(terms).over_r(near2);
  }
  HWY_INLINE V over_r(V r2, V number) const {
    V k = hn::Zero(D());
    for (size_t n = 0; n < laws.size(); ++n) {
      const auto own = hn::And(hn::Eq(number, set(static_cast<Real>(n))), hn::Lt(r2, set(laws[n].cutoff2)));
      if (hn::AllFalse(D(), own)) continue;
      k = hn::IfThenElse(own, of_one(laws[n], hn::Max(r2, set(laws[n].core2))), k);
    }
    return k;
  }
};

// Of one law: the only one.
template <class Law, class Real>
HWY_INLINE Law law_of(const PairForce<Real>& force) {
  if constexpr (std::is_same_v<Law, Several<Real>>)
    return Law(force);
  else
    return Law(force.laws[0]);
}

template <bool kDamped, class Real, class Law>
HWY_INLINE void sum_forces(const PairForce<Real>& force, const PairRows& rows, const Real* x, const Real* v,
                           Real* f) {
  using Vs = Vectors<Real>;
  using V = typename Vs::V;
  using Index = typename Vs::Index;
  const typename Vs::D d;
  const typename Vs::I ii;
  const size_t lanes = hn::Lanes(d);
  constexpr bool kSeveral = std::is_same_v<Law, Several<Real>>;
  const Law law = law_of<Law>(force);
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
      row_of_strengths =
          hn::Mul(hn::GatherIndex(d, home + 3, own_lanes), hn::Set(d, static_cast<Real>(force.materials)));
    V f0 = zero, f1 = zero, f2 = zero;
    const uint32_t* const end = rows.entry.data() + rows.begin[g + 1] * lanes;
    for (const uint32_t* at = rows.entry.data() + rows.begin[g] * lanes; at < end; at += lanes) {
      const Index j = Vs::entries(at);
      V other[3];
      load_records(x, at, j, other);
      V d0 = hn::Sub(other[0], x0), d1 = hn::Sub(other[1], x1), d2 = hn::Sub(other[2], x2);
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
      // Particles at one point, as a particle and itself where rows are filled up, have k*d = 0.
      auto pair = hn::Lt(r2, cutoff2);
      const V near2 = hn::Max(r2, core2);
      auto which = own_lanes;
      if (scaled) which = hn::ConvertTo(ii, hn::Add(row_of_strengths, hn::GatherIndex(d, x + 3, j)));
      V k;
      if constexpr (kSeveral)
        k = law.over_r(r2, hn::GatherIndex(d, force.law_index.data(), which));
      else
        k = law.over_r(near2);
      if (kDamped) {
        load_records(v, at, j, other);
        const V w0 = hn::Sub(other[0], v0), w1 = hn::Sub(other[1], v1), w2 = hn::Sub(other[2], v2);
        const V closing = hn::Add(hn::Add(hn::Mul(w0, d0), hn::Mul(w1, d1)), hn::Mul(w2, d2));
        const V rest = hn::Sub(one, hn::Mul(near2, inverse_cutoff2));
        const V c = hn::Div(hn::Mul(damping, hn::Mul(rest, rest)), near2);
        k = hn::Sub(k, hn::Mul(c, closing));
      }
      if (scaled) {
        const V strength = hn::GatherIndex(d, force.strength.data(), which);
        k = hn::Mul(k, hn::Abs(strength));
        pair = hn::AndNot(hn::And(hn::Lt(strength, zero), hn::Ge(r2, hn::Set(d, force.contact2))), pair);
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
  using Kind = typename LawTerms<Real>::Kind;
  const bool damped = force.damping > 0;
  const auto by = [&]<class Law>() HWY_ATTR {
    if (damped)
      sum_forces<true, Real, Law>(force, rows, x, v, f);
    else
      sum_forces<false, Real, Law>(force, rows, x, v, f);
  };
  if (force.laws.size() > 1) return by.template operator()<Several<Real>>();
  switch (force.laws[0].kind) {
    case Kind::lennard_jones:
      return by.template operator()<LennardJones<Real>>();
    case Kind::cubic:
      return by.template operator()<Cubic<Real>>();
    case Kind::arc:
      return by.template operator()<Arc<Real>>();
    case Kind::asked:
      return by.template operator()<Asked<Real>>();
  }
}
void forces64(const PairForce<double>& force, const PairRows& rows, const double* x, const double* v,
              double* f) {
  forces_of(force, rows, x, v, f);
}
void forces32(const PairForce<float>& force, const PairRows& rows, const float* x, const float* v, float* f) {
  forces_of(force, rows, x, v, f);
}
void over_r_of(const LawTerms<double>& law, const double* r2, size_t count, double* out) {
  const hn::ScalableTag<double> d;
  const auto core2 = hn::Set(d, law.core2), cutoff2 = hn::Set(d, law.cutoff2);
  double rest[HWY_MAX_BYTES / sizeof(double)];
  for (size_t k = 0; k < count; k += hn::Lanes(d)) {
    const size_t here = std::min(count - k, hn::Lanes(d));
    std::fill_n(rest, hn::Lanes(d), law.core2);
    std::copy_n(r2 + k, here, rest);
    const auto at = hn::LoadU(d, rest);
    const auto value = Several<double>::of_one(law, hn::Max(at, core2));
    hn::StoreU(hn::IfThenElseZero(hn::Lt(at, cutoff2), value), d, rest);
    std::copy_n(rest, here, out + k);
  }
}
size_t nearer_ones(const double* const at[3], const uint64_t* names, std::span<const NearRange> ranges,
                   const double* home, const double* box, double range2, uint64_t* found) {
  const hn::ScalableTag<double> d;
  const hn::ScalableTag<uint64_t> u;
  const size_t lanes = hn::Lanes(d);
  const bool ring = box[0] > 0 || box[1] > 0 || box[2] > 0;
  size_t n = 0;
  for (const NearRange& range : ranges)
    for (size_t c = range.begin; c < range.end; c += lanes) {
      auto r2 = hn::Zero(d);
      for (int axis = 0; axis < 3; ++axis) {
        auto of = hn::Sub(hn::LoadU(d, at[axis] + c), hn::Set(d, home[axis]));
        if (ring && box[axis] > 0)
          of = hn::Sub(of, hn::Mul(hn::Set(d, box[axis]), hn::Round(hn::Mul(of, hn::Set(d, 1 / box[axis])))));
        r2 = hn::Add(r2, hn::Mul(of, of));
      }
      // Few of them are near: one by one costs less than a compressed store.
      uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Lt(r2, hn::Set(d, range2)), bits);
      uint32_t near = bits[0];
      if (c + lanes > range.end) near &= (1u << (range.end - c)) - 1;
      for (; near != 0; near &= near - 1) found[n++] = names[c + static_cast<size_t>(std::countr_zero(near))];
    }
  // Each goes where as many stand before it as are less: for few, without a branch that depends on them.
  constexpr size_t kFew = 64;
  if (n > kFew) {
    std::sort(found, found + n);
    return n;
  }
  uint64_t few[kFew + hn::MaxLanes(u)];
  std::copy_n(found, n, few);
  hn::StoreU(hn::Set(u, ~uint64_t{0}), u, few + n);
  for (size_t k = 0; k < n; ++k) {
    const auto own = hn::Set(u, few[k]);
    size_t less = 0;
    for (size_t m = 0; m < n; m += lanes) less += hn::CountTrue(u, hn::Lt(hn::LoadU(u, few + m), own));
    found[less] = few[k];
  }
  return n;
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
HWY_EXPORT(over_r_of);
HWY_EXPORT(nearer_ones);
HWY_EXPORT(lanes64);
HWY_EXPORT(lanes32);
HWY_EXPORT(simd);

void pair_forces(const PairForce<double>& force, const PairRows& rows, const double* x, const double* v,
                 double* f) {
  HWY_DYNAMIC_DISPATCH(forces64)(force, rows, x, v, f);
}
void pair_forces(const PairForce<float>& force, const PairRows& rows, const float* x, const float* v,
                 float* f) {
  HWY_DYNAMIC_DISPATCH(forces32)(force, rows, x, v, f);
}
void pair_over_r(const LawTerms<double>& law, const std::vector<double>& r2, std::vector<double>& over_r) {
  over_r.resize(r2.size());
  HWY_DYNAMIC_DISPATCH(over_r_of)(law, r2.data(), r2.size(), over_r.data());
}
size_t nearer(const std::vector<double> (&at)[3], const std::vector<uint64_t>& names,
              std::span<const NearRange> ranges, const Vec3& home, const std::array<double, 3>& box,
              double range2, std::vector<uint64_t>& found) {
  const double* const axes[3] = {at[0].data(), at[1].data(), at[2].data()};
  return HWY_DYNAMIC_DISPATCH(nearer_ones)(axes, names.data(), ranges, home.data(), box.data(), range2,
                                           found.data());
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
LawTerms<Real>::LawTerms(const PairLaw& of)
    : law(&of),
      cutoff2(static_cast<Real>(of.cutoff() * of.cutoff())),
      core2(static_cast<Real>(of.core() * of.core())) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  const auto take = [&](const auto& list, auto... member) {
    pieces = list.size();
    for (size_t k = 0; k < std::max(pieces, kLeastPieces); ++k) {
      const auto& piece = list[std::min(k, pieces - 1)];
      size_t c = 0;
      (coefficient[c++].push_back(real(piece.*member)), ...);
      if (k > 0) joint2.push_back(real(piece.r * piece.r));
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
}
template struct LawTerms<double>;
template struct LawTerms<float>;

template <class Real>
PairForce<Real>::PairForce(const Rule& rule, const Periodic& periodic) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  for (size_t k = 0; k < rule.laws(); ++k) laws.emplace_back(rule.law_at(k));
  const double cutoff = rule.cutoff(), core = rule.core();
  cutoff2 = real(cutoff * cutoff);
  core2 = real(core * core);
  damping = real(rule.damping.coefficient);
  inverse_cutoff2 = real(1 / (cutoff * cutoff));
  const bool several = laws.size() > 1;
  bool scaled = several || !rule.contact.empty();
  for (const auto& row : rule.strength)
    for (const double factor : row) scaled |= factor != 1;
  if (scaled) {
    materials = rule.strength.size();
    for (size_t i = 0; i < materials; ++i)
      for (size_t j = 0; j < materials; ++j) {
        const bool touch = !rule.contact.empty() && rule.contact[i][j] != 0;
        strength.push_back(real(touch ? -rule.strength[i][j] : rule.strength[i][j]));
        if (several) law_index.push_back(real(static_cast<double>(rule.law_between(i, j))));
      }
    contact2 = real(rule.contact_distance * rule.contact_distance);
  }
  set_box(periodic);
}

template <class Real>
void PairForce<Real>::set_box(const Periodic& periodic) {
  for (int axis = 0; axis < 3; ++axis) {
    if (periodic.extent[axis] <= 0) continue;
    ring = true;
    extent[axis] = static_cast<Real>(periodic.extent[axis]);
    inverse_extent[axis] = static_cast<Real>(1 / periodic.extent[axis]);
  }
}
template struct PairForce<double>;
template struct PairForce<float>;

}  // namespace cuboct
#endif
