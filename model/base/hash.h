// SPDX-License-Identifier: MIT
// A 64-bit hash of a sequence of integers: each is folded in by the finaliser of splitmix64 (Steele, Lea,
// Flood 2014). Not cryptographic; equal on every machine.
#pragma once

#include <cstdint>

#include "model/base/fixed_math.h"

namespace cuboct {

class Hash {
 public:
  CUBOCT_HD constexpr Hash& add(int64_t value) {
    uint64_t z = (value_ ^ static_cast<uint64_t>(value)) + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    value_ = z ^ (z >> 31);
    return *this;
  }
  CUBOCT_HD constexpr uint64_t value() const { return value_; }
  // Goes on from an earlier value().
  CUBOCT_HD constexpr void resume(uint64_t value) { value_ = value; }

 private:
  uint64_t value_ = 0;
};

}  // namespace cuboct
