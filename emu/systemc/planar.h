// SPDX-License-Identifier: MIT
// The planar test of one candidate against all slots of a node, four slots per operation: the same answer as
// `may_interact` of model/contract/fixed_rule.h.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "model/contract/fixed_rule.h"

namespace cuboct::emu {

constexpr int kPlanarSlots = 256;  // the most that a node holds (hw/plan/plan.h)

// The slots' positions, B fractional bits: the leading ones of P.
struct PlanarSlots {
  std::array<std::array<int32_t, kPlanarSlots>, 3> x;
  int count = 0;

  void clear() { count = 0; }
  // `shift` is P - B.
  void add(const std::array<int32_t, 3>& at, int shift) {
    for (size_t a = 0; a < 3; ++a) x[a][static_cast<size_t>(count)] = at[a] >> shift;
    ++count;
  }
};

// Bit k: slot k may interact.
struct PlanarMask {
  std::array<uint64_t, kPlanarSlots / 64> word{};

  void set(uint32_t slot) { word[slot / 64] |= uint64_t{1} << slot % 64; }
  void clear(uint32_t slot) { word[slot / 64] &= ~(uint64_t{1} << slot % 64); }
  // 64 bits from `slot` on.
  uint64_t from(uint32_t slot) const {
    const uint32_t w = slot / 64, s = slot % 64;
    const uint64_t low = word[w] >> s;
    return s == 0 || w + 1 == word.size() ? low : low | word[w + 1] << (64 - s);
  }
};

class PlanarTest {
 public:
  explicit PlanarTest(const FixedRule& rule) : shift_(rule.widths.position_frac - rule.widths.filter_frac) {
    // Sizes, below 2^(B+1) each with B <= 16, and their sums fit.
    for (size_t k = 0; k < 3; ++k) limit_[k] = static_cast<int32_t>(rule.planar[k]);
  }

  int shift() const { return shift_; }

  PlanarMask operator()(const PlanarSlots& slots, const std::array<int32_t, 3>& candidate) const {
    PlanarMask mask;
    for (int k = 0; k < slots.count; k += kLanes) {
      const Lanes dx = size(slots.x[0], k, candidate[0] >> shift_),
                  dy = size(slots.x[1], k, candidate[1] >> shift_),
                  dz = size(slots.x[2], k, candidate[2] >> shift_);
      const Lanes xy = dx + dy;
      // The sign of limit - value says that a limit is passed; one sign is enough.
      const Lanes far = (limit_[0] - dx) | (limit_[0] - dy) | (limit_[0] - dz) | (limit_[1] - xy) |
                        (limit_[1] - (dy + dz)) | (limit_[1] - (dz + dx)) | (limit_[2] - (xy + dz));
      const uint64_t near = ~signs(far) & ((1u << kLanes) - 1);
      mask.word[static_cast<size_t>(k) / 64] |= near << k % 64;
    }
    // What lies behind the last slot was tested too.
    const int rest = slots.count % 64;
    if (rest != 0) mask.word[static_cast<size_t>(slots.count) / 64] &= (uint64_t{1} << rest) - 1;
    return mask;
  }

 private:
  static constexpr int kLanes = 4;
  typedef int32_t Lanes __attribute__((vector_size(4 * kLanes)));
  typedef float Floats __attribute__((vector_size(4 * kLanes)));

  Lanes size(const std::array<int32_t, kPlanarSlots>& x, int slot, int32_t candidate) const {
    Lanes own;
    std::memcpy(&own, &x[static_cast<size_t>(slot)], sizeof own);
    const Lanes e = candidate - own;
    return e ^ (e >> 31);
  }
  static unsigned signs(Lanes v) {
#ifdef __SSE__
    return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<Floats>(v)));
#else
    unsigned bits = 0;
    for (int l = 0; l < kLanes; ++l) bits |= (static_cast<uint32_t>(v[l]) >> 31) << l;
    return bits;
#endif
  }

  const int shift_;  // P - B
  std::array<int32_t, 3> limit_{};
};

}  // namespace cuboct::emu
