// SPDX-License-Identifier: MIT
// A coordinate of 64 bits as others see it: the ring is 2^(64 - spare) of its units, and a number of 32 bits
// begins `drop` bits above the lowest of 64.
#pragma once

#include <cstdint>

#include "model/base/fixed_math.h"

namespace cuboct::gpu {

struct RealRing {
  int spare, drop;
  template <class Number>
  CUBOCT_HD Number place(int64_t x) const {
    return static_cast<Number>(static_cast<uint64_t>(x) << spare >> drop);
  }
};

}  // namespace cuboct::gpu
