// SPDX-License-Identifier: MIT
#include "emu/lattice/hash_particles.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "emu/lattice/hash_particles.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::emu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kGroup>;
using U = hn::RebindToUnsigned<D>;
using V = hn::Vec<U>;
constexpr D d;
constexpr U u;
constexpr uint32_t kLanes = hn::MaxLanes(d);

// Chains of dependent multiplications, side by side so that the units are not left waiting.
constexpr uint32_t kWays = 4;
constexpr uint32_t kStride = kWays * kLanes;

// Hash::add of model/base/hash.h.
HWY_INLINE void add(V hash[kWays], const V value[kWays]) {
  V z[kWays];
  for (uint32_t w = 0; w < kWays; ++w)
    z[w] = hn::Add(hn::Xor(hash[w], value[w]), hn::Set(u, 0x9e3779b97f4a7c15u));
  for (uint32_t w = 0; w < kWays; ++w)
    z[w] = hn::Mul(hn::Xor(z[w], hn::ShiftRight<30>(z[w])), hn::Set(u, 0xbf58476d1ce4e5b9u));
  for (uint32_t w = 0; w < kWays; ++w)
    z[w] = hn::Mul(hn::Xor(z[w], hn::ShiftRight<27>(z[w])), hn::Set(u, 0x94d049bb133111ebu));
  for (uint32_t w = 0; w < kWays; ++w) hash[w] = hn::Xor(z[w], hn::ShiftRight<31>(z[w]));
}

// A whole double below 2^51 as a 64-bit integer.
HWY_INLINE V integer(hn::Vec<D> whole) {
  const auto magic = hn::Set(d, kMagic);
  return hn::Sub(hn::BitCast(u, hn::Add(whole, magic)), hn::BitCast(u, magic));
}

uint64_t hash_particles(const Particles& particles, const Lattice& lattice, const uint32_t* cell,
                        const Widths& widths, uint32_t begin, uint32_t end) {
  const auto edge = hn::Set(d, std::ldexp(1.0, widths.position_frac)),
             inverse = hn::Set(d, std::ldexp(1.0, -widths.position_frac)),
             guard = hn::Set(d, std::ldexp(1.0, widths.guard));
  const bool pd = particles.u[0].size() > 0;
  V sum = hn::Zero(u);
  for (uint32_t i = begin; i < end; i += kStride) {
    uint64_t head[5][kStride] = {};  // id, type, cell
    for (uint32_t l = 0; l < std::min(kStride, end - i); ++l) {
      const uint32_t id = particles.id_of(i + l);
      head[0][l] = id;
      head[1][l] = particles.type[i + l];
      for (int a = 0; a < 3; ++a)
        head[2 + a][l] = static_cast<uint64_t>(static_cast<int64_t>(lattice.cell(cell[id])[a]));
    }
    V hash[kWays], value[kWays];
    for (V& h : hash) h = hn::Zero(u);
    for (const auto& word : head) {
      for (uint32_t w = 0; w < kWays; ++w) value[w] = hn::LoadU(u, word + w * kLanes);
      add(hash, value);
    }
    const auto load = [&](const PaddedArray<double>& field, uint32_t w) {
      const uint32_t at = i + w * kLanes;  // what is beyond the end does not count
      return hn::LoadU(d, field.data() + (at < end ? at : i));
    };
    const auto residue = [&](const PaddedArray<int32_t>& field, uint32_t w) {
      const uint32_t at = i + w * kLanes;
      return hn::PromoteTo(d, hn::LoadU(hn::Rebind<int32_t, D>(), field.data() + (at < end ? at : i)));
    };
    for (int a = 0; a < 3; ++a) {
      for (uint32_t w = 0; w < kWays; ++w) {
        const auto x = load(particles.x[a], w);
        const auto visible = hn::Sub(x, hn::Mul(hn::Floor(hn::Mul(x, inverse)), edge));
        value[w] = integer(hn::MulAdd(visible, guard, residue(particles.residue[a], w)));
      }
      add(hash, value);
      for (uint32_t w = 0; w < kWays; ++w) value[w] = integer(load(particles.v[a], w));
      add(hash, value);
      for (uint32_t w = 0; w < kWays; ++w) value[w] = pd ? integer(load(particles.u[a], w)) : hn::Zero(u);
      add(hash, value);
    }
    for (uint32_t w = 0; w < kWays; ++w) {
      const uint32_t at = i + w * kLanes;
      if (at < end) sum = hn::Add(sum, hn::IfThenElseZero(hn::FirstN(u, end - at), hash[w]));
    }
  }
  return hn::GetLane(hn::SumOfLanes(u, sum));
}

}  // namespace cuboct::emu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct::emu {
HWY_EXPORT(hash_particles);
uint64_t hash_particles(const Particles& particles, const Lattice& lattice, const uint32_t* cell,
                        const Widths& widths, uint32_t begin, uint32_t end) {
  return HWY_DYNAMIC_DISPATCH(hash_particles)(particles, lattice, cell, widths, begin, end);
}
}  // namespace cuboct::emu
#endif
