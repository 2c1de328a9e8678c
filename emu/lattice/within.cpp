// SPDX-License-Identifier: MIT
#include <bit>

#include "emu/lattice/search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "emu/lattice/within.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL)
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cuboct::emu::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

uint32_t within(const int32_t* x, const int32_t* y, const int32_t* z, uint32_t count, const int32_t at[3],
                float reach2, uint32_t* found) {
  const hn::CappedTag<int32_t, 16> i;
  const hn::Rebind<float, decltype(i)> f;
  const auto distance = [&](const int32_t* of, int a, uint32_t k) {
    return hn::ConvertTo(f, hn::Sub(hn::LoadU(i, of + k), hn::Set(i, at[a])));
  };
  uint32_t n = 0;
  for (uint32_t k = 0; k < count; k += static_cast<uint32_t>(hn::Lanes(i))) {
    const auto dx = distance(x, 0, k), dy = distance(y, 1, k), dz = distance(z, 2, k);
    const auto r2 = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(f, hn::Le(r2, hn::Set(f, reach2)), bytes);
    uint32_t bits = bytes[0] | static_cast<uint32_t>(bytes[1]) << 8;
    if (count - k < 16) bits &= (1u << (count - k)) - 1;
    for (; bits != 0; bits &= bits - 1) found[n++] = k + static_cast<uint32_t>(std::countr_zero(bits));
  }
  return n;
}

}  // namespace cuboct::emu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cuboct::emu {
HWY_EXPORT(within);
uint32_t within(const int32_t* x, const int32_t* y, const int32_t* z, uint32_t count, const int32_t at[3],
                float reach2, uint32_t* found) {
  return HWY_DYNAMIC_DISPATCH(within)(x, y, z, count, at, reach2, found);
}
}  // namespace cuboct::emu
#endif
