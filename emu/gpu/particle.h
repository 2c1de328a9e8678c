// SPDX-License-Identifier: MIT
// What a particle is made of on a device, in groups of four numbers that travel together.
#pragma once

#include <cstddef>
#include <cstdint>

#include "model/base/fixed_math.h"

namespace cuboct::gpu {

template <typename Number, typename Last>
struct alignas(16) Four {
  Number at[3];
  Last last;
};

// The last number of a position: the type, and above it a near anchor (emu/gpu/device/storage.h).
inline constexpr int kTypeBits = 8;
template <typename Last>
CUBOCT_HD constexpr int type_in(Last last) {
  return static_cast<int>(last & 255);
}

template <typename Number>
struct Three {
  Number at[3];
};

// Bits of a cell's edge that a fixed position has: it may lie in its neighbour cell, or beyond by a step, and
// has 32.
inline constexpr int kMostVisibleBits = 30;

// The bits of a fixed position below those that pairs see, `bits` an axis (Widths::guard). They stay with the
// particle's owner, apart from its position: pairs do not load them. Real positions keep none.
inline constexpr int kMostResidueBits = 32;
template <bool kKept>
struct Residues {
  uint32_t* words;
  int bits;

  // Three axes in as few words as hold them.
  CUBOCT_HD static constexpr size_t words_for(int bits) {
    if (!kKept) return 0;
    return bits <= 10 ? 1 : bits <= 21 ? 2 : 3;
  }
  CUBOCT_HD Three<uint32_t> load(size_t i) const {
    Three<uint32_t> value{};
    if constexpr (kKept) {
      const uint32_t* const at = words + i * words_for(bits);
      if (words_for(bits) == 3) return {{at[0], at[1], at[2]}};
      const uint64_t packed = words_for(bits) == 1 ? at[0] : at[0] | uint64_t{at[1]} << 32;
      for (int a = 0; a < 3; ++a)
        value.at[a] = static_cast<uint32_t>(packed >> a * bits) & ((1u << bits) - 1);
    }
    return value;
  }
  // Each below 2^bits.
  CUBOCT_HD void store(size_t i, const Three<uint32_t>& value) const {
    if constexpr (kKept) {
      uint32_t* const at = words + i * words_for(bits);
      if (words_for(bits) == 3) {
        for (int a = 0; a < 3; ++a) at[a] = value.at[a];
        return;
      }
      const uint64_t packed = value.at[0] | uint64_t{value.at[1]} << bits | uint64_t{value.at[2]} << 2 * bits;
      at[0] = static_cast<uint32_t>(packed);
      if (words_for(bits) == 2) at[1] = static_cast<uint32_t>(packed >> 32);
    }
  }
};

}  // namespace cuboct::gpu
