// SPDX-License-Identifier: MIT
// What a particle is made of on a device, in groups of four numbers that travel together.
#pragma once

#include <cstdint>

#include "model/fixed_math.h"

namespace cuboct::gpu {

template <typename Number, typename Last>
struct alignas(16) Four {
  Number at[3];
  Last last;
};

// The last number of a position: the type, and above it a thin anchor (gpu_ref/storage.h).
inline constexpr int kTypeBits = 8;
template <typename Last>
CUBOCT_HD constexpr int type_in(Last last) {
  return static_cast<int>(last & 255);
}

template <typename Number>
struct Three {
  Number at[3];
};

}  // namespace cuboct::gpu
