// SPDX-License-Identifier: MIT
// What a particle is made of on a device, in groups of four numbers that travel together.
#pragma once

#include <cstdint>

namespace cuboct::gpu {

template <typename Number, typename Last>
struct alignas(16) Four {
  Number at[3];
  Last last;
};

template <typename Number>
struct Three {
  Number at[3];
};

}  // namespace cuboct::gpu
