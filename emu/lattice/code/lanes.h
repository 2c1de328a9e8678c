// SPDX-License-Identifier: MIT
// Vectors for compiled code of rules, in the terms of GCC and Clang. The arithmetic is that of kernel_rule.h:
// integers in doubles, one fused multiply-add for each rounding.
#pragma once

#include <cstddef>
#include <cstdint>

// GCC takes two thirds of its time for this header; its own names do without.
#if defined(__x86_64__) && defined(__clang__)
#include <immintrin.h>
#endif

#include "emu/lattice/code/job.h"
#include "model/base/hash.h"

namespace cuboct::emu {
namespace {

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
constexpr int kLanes = 8;
#define CUBOCT_512
#if defined(__clang__)
#define CUBOCT_512_ANY(a) _mm512_movepi64_mask(reinterpret_cast<__m512i>(a))
#define CUBOCT_512_FMA(a, b, c) reinterpret_cast<V>(_mm512_fmadd_pd(a, b, c))
#define CUBOCT_512_FLOOR(a) reinterpret_cast<V>(_mm512_roundscale_pd(a, 9))
#define CUBOCT_512_GATHER(from, at) \
  reinterpret_cast<V>(_mm512_i64gather_pd(reinterpret_cast<__m512i>(at), from, 8))
#else
#define CUBOCT_512_ANY(a) __builtin_ia32_cvtq2mask512(reinterpret_cast<LongLongs>(a))
#define CUBOCT_512_FMA(a, b, c) __builtin_ia32_vfmaddpd512_mask(a, b, c, -1, 4)
#define CUBOCT_512_FLOOR(a) __builtin_ia32_rndscalepd_mask(a, 9, a, -1, 4)
#define CUBOCT_512_GATHER(from, at) \
  __builtin_ia32_gatherdiv8df(V{}, from, reinterpret_cast<LongLongs>(at), -1, 8)
#endif
#define CUBOCT_EACH(of) of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)
#elif defined(__AVX2__) && defined(__FMA__)
constexpr int kLanes = 4;
#define CUBOCT_256
#if defined(__clang__)
#define CUBOCT_256_FMA(a, b, c) reinterpret_cast<V>(_mm256_fmadd_pd(a, b, c))
#define CUBOCT_256_GATHER(from, at) \
  reinterpret_cast<V>(_mm256_i64gather_pd(from, reinterpret_cast<__m256i>(at), 8))
#else
#define CUBOCT_256_FMA(a, b, c) __builtin_ia32_vfmaddpd256(a, b, c)
#define CUBOCT_256_GATHER(from, at) \
  __builtin_ia32_gatherdiv4df(V{}, from, reinterpret_cast<LongLongs>(at), reinterpret_cast<V>(~W{}), 8)
#endif
#define CUBOCT_EACH(of) of(0), of(1), of(2), of(3)
#else
constexpr int kLanes = 2;
#define CUBOCT_EACH(of) of(0), of(1)
#endif
constexpr uint32_t kEntryLanes = 8;

typedef double V __attribute__((vector_size(8 * kLanes)));
typedef int64_t W __attribute__((vector_size(8 * kLanes)));  // integers, or truths: 0 and -1
typedef uint64_t U __attribute__((vector_size(8 * kLanes)));
typedef long long LongLongs __attribute__((vector_size(8 * kLanes)));
typedef double Unaligned __attribute__((vector_size(8 * kLanes), aligned(8)));
typedef int32_t Half __attribute__((vector_size(4 * kLanes), aligned(4)));

constexpr double kTwo52 = 0x1p52, kMagic = 0x1.8p52;

inline V splat(double a) { return a - V{}; }
inline W splat(int64_t a) { return a - W{}; }
inline V load(const double* from) { return *reinterpret_cast<const Unaligned*>(from); }
inline void store(double* to, V a) { *reinterpret_cast<Unaligned*>(to) = a; }
inline V select(W truth, V a, V b) { return truth ? a : b; }
inline V value_of(W truth) { return reinterpret_cast<V>(truth & reinterpret_cast<W>(splat(1.0))); }
inline W truth_of(V a) { return a != V{}; }

inline bool any(W truth) {
#if defined(CUBOCT_512)
  return CUBOCT_512_ANY(truth) != 0;
#elif defined(CUBOCT_256)
  return __builtin_ia32_movmskpd256(reinterpret_cast<V>(truth)) != 0;
#else
  int64_t all = 0;
  for (int l = 0; l < kLanes; ++l) all |= truth[l];
  return all != 0;
#endif
}

// Lane l is true where bit l is set.
inline W lanes_of(uint32_t bits) {
#define CUBOCT_BIT(l) int64_t{1} << l
  const W bit = {CUBOCT_EACH(CUBOCT_BIT)};
  return (splat(static_cast<int64_t>(bits)) & bit) != W{};
}

// a b + c, rounded once.
inline V fused(V a, V b, V c) {
#if defined(CUBOCT_512)
  return CUBOCT_512_FMA(a, b, c);
#elif defined(CUBOCT_256)
  return CUBOCT_256_FMA(a, b, c);
#else
#define CUBOCT_FMA(l) __builtin_fma(a[l], b[l], c[l])
  return V{CUBOCT_EACH(CUBOCT_FMA)};
#endif
}

inline V floor_of(V a) {
#if defined(CUBOCT_512)
  return CUBOCT_512_FLOOR(a);
#elif defined(CUBOCT_256)
  return __builtin_ia32_roundpd256(a, 9);
#else
#define CUBOCT_FLOOR(l) __builtin_floor(a[l])
  return V{CUBOCT_EACH(CUBOCT_FLOOR)};
#endif
}

// round_odd of a whole number, for the factor of its shift.
inline V rounded(V a, V factor) { return fused(a, factor, splat(kMagic)) - splat(kMagic); }
inline V least(V a, V b) { return a < b ? a : b; }
inline V most(V a, V b) { return a > b ? a : b; }
inline V magnitude(V a) {
  return reinterpret_cast<V>(reinterpret_cast<W>(a) & splat(int64_t{0x7fffffffffffffff}));
}

inline V gather(const double* from, W at) {
#if defined(CUBOCT_512)
  return CUBOCT_512_GATHER(from, at);
#elif defined(CUBOCT_256)
  return CUBOCT_256_GATHER(from, at);
#else
#define CUBOCT_GATHER(l) from[at[l]]
  return V{CUBOCT_EACH(CUBOCT_GATHER)};
#endif
}
inline U gather(const uint64_t* from, W at) {
  return reinterpret_cast<U>(gather(reinterpret_cast<const double*>(from), at));
}

// Of a particle's type, of a pair of types, of a particle: lanes begin at these places.
inline V of_type(const double* from, const uint8_t* type) {
#define CUBOCT_TYPE(l) from[type[l]]
  return V{CUBOCT_EACH(CUBOCT_TYPE)};
}
inline V of_types(const double* from, const uint8_t* own, const uint8_t* other, int64_t types) {
#define CUBOCT_TYPES(l) from[own[l] * types + other[l]]
  return V{CUBOCT_EACH(CUBOCT_TYPES)};
}
inline V ids(const uint32_t* id, ptrdiff_t at) {
#define CUBOCT_ID(l) static_cast<double>(id != nullptr ? id[at + l] : static_cast<uint32_t>(at + l))
  return V{CUBOCT_EACH(CUBOCT_ID)};
}
// Of bonds' kinds. In a crystal those of an entry are alike.
struct Kinds {
  const uint32_t* kind;
  int64_t count;
  bool alike = true;
  Kinds(const uint32_t* from, int64_t constants) : kind(from), count(constants) {
    for (int l = 1; l < kLanes; ++l) alike &= kind[l] == kind[0];
  }
  V operator()(const double* from) const {
    if (__builtin_expect(alike, 1)) return splat(from[kind[0] * count]);
#define CUBOCT_KIND(l) from[kind[l] * count]
    return V{CUBOCT_EACH(CUBOCT_KIND)};
  }
};

// A whole number below 2^51 that is not negative, as an integer.
inline W whole(V a) { return reinterpret_cast<W>(a + splat(kTwo52)) ^ reinterpret_cast<W>(splat(kTwo52)); }
// An integer of 32 bits with 2^31 added, as a double.
inline V from_biased(U bits) {
  return reinterpret_cast<V>(bits | reinterpret_cast<U>(splat(kTwo52))) - splat(kTwo52 + 0x1p31);
}
inline V fraction(U bits) {
  return reinterpret_cast<V>(bits | reinterpret_cast<U>(splat(kTwo52))) - splat(kTwo52);
}

// FixedTable's value at `a`. `law`: where the entries of each lane's law begin.
template <bool kOctaves, int kDegree, bool kPacked>
inline V lookup(const CodeTable& table, V argument, W law) {
  const V a = argument + V{};  // no bit of -0.0
  W index;
  V t;
  if constexpr (kOctaves) {
    const U bits = reinterpret_cast<U>(a);
    const W place = reinterpret_cast<W>(bits >> table.index_shift) - splat(table.index_base);
    const W inside = place > splat(int64_t{-1});
    index = place & inside & splat(table.index_mask);
    t = reinterpret_cast<V>(reinterpret_cast<W>(fraction(bits & reinterpret_cast<U>(splat(table.t_mask)))) &
                            inside);
  } else {
    const U bits = reinterpret_cast<U>(a + splat(kTwo52));
    index = reinterpret_cast<W>(bits >> table.index_shift) & splat(table.index_mask);
    t = fraction(bits & reinterpret_cast<U>(splat(table.t_mask)));
  }
  index = index + law;
  const U word = gather(table.words, index);
  const V factor = splat(table.factor);
  V c0, slope;
  if constexpr (kPacked) {
    const U low = reinterpret_cast<U>(splat(table.low_mask));
    c0 = reinterpret_cast<V>((word & low) | reinterpret_cast<U>(splat(kMagic)));
    slope = reinterpret_cast<V>(word & ~low);
  } else {
    c0 = from_biased(word & reinterpret_cast<U>(splat(int64_t{0xffffffff})));
    slope = from_biased(word >> 32);
  }
  if constexpr (kDegree == 2) slope = slope + rounded(gather(table.c2, index) * t, factor);
  if constexpr (kPacked) return fused(slope * t, factor, c0) - splat(table.bias);
  return c0 + rounded(slope * t, factor);
}
inline W law_of(V number, const CodeTable& table) { return whole(number) << table.index_bits; }

// `a` in the bits whose least and greatest numbers are low and -low - 1. What does not fit is wrapped,
// exactly: divisions by powers of two. `bad` gets the lanes of `counts` that did not fit. kBothSigns: as of
// VectorBlock.
template <bool kBothSigns>
inline V checked(V a, V low, W counts, W& bad) {
  const V lap = -2.0 * low;
  const W above = a >= -low, outside = (a < low) | above, misfit = kBothSigns ? (a <= low) | above : outside;
  bad |= misfit & counts;
  if (__builtin_expect(any(outside), 0)) {
    const V laps = floor_of((a - low) / lap);
    return outside ? a - laps * lap : a;
  }
  return a;
}

// floor(log2 a) of a whole number; -1 where it is not positive.
inline V leading(V a) {
  const U exponent = reinterpret_cast<U>(a) >> 52;
  return a > V{} ? __builtin_convertvector(reinterpret_cast<W>(exponent), V) - 1023.0 : splat(-1.0);
}
inline V power_of_two(W exponent) { return reinterpret_cast<V>((exponent + 1023) << 52); }
// Op::align.
inline V aligned(V a, int64_t place, int64_t step) {
  const W lead = reinterpret_cast<W>(reinterpret_cast<U>(a) >> 52) - 1023;
  const V moved = floor_of(a * power_of_two(place - (lead & -step)));
  return a > V{} ? moved : V{};
}
// Op::shift.
inline V shifted(V a, V by) {
  const W bits = __builtin_convertvector(by, W);
  const V scale = power_of_two(bits), inexact = scale + scale * 0x1p-52;
  return by >= V{} ? a * scale : rounded(a, inexact);
}
// Hash::add, of a number for each lane. Compilers make vectors of the products.
inline U hash_added(U hash, W value) {
  U z = (hash ^ reinterpret_cast<U>(value)) + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
// A whole number below 2^51 in magnitude, as an integer.
inline W integer(V a) { return reinterpret_cast<W>(a + splat(kMagic)) - reinterpret_cast<W>(splat(kMagic)); }
// Op::noise: the hash's upper bits, with a sign. Its `width` is below 52, as doubles hold it.
inline V noise(int64_t seed, V a, V b, V c, int64_t width) {
  const U seeded = U{} + Hash().add(seed).value();
  const U mixed =
      hash_added(hash_added(hash_added(seeded, integer(least(a, b))), integer(most(a, b))), integer(c));
  const U biased = (mixed ^ (U{} + (uint64_t{1} << 63))) >> (64 - width);
  return fraction(biased) - splat(static_cast<double>(int64_t{1} << (width - 1)));
}

}  // namespace
}  // namespace cuboct::emu
