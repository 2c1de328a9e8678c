// SPDX-License-Identifier: MIT
// Random stalls of links: whether a link is gated in a cycle is a hash of (seed, link, cycle), so that it
// depends on no order of evaluation and is the same for every node implementation.
#pragma once

#include <cstdint>

namespace cuboct::emu {

// The finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
inline uint64_t mix(uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

class StallSource {
 public:
  StallSource() = default;
  // `rate` in [0, 1): the share of cycles in which a link passes nothing.
  StallSource(double rate, uint64_t seed)
      : threshold_(static_cast<uint64_t>(rate * 18446744073709551616.0)), seed_(mix(seed)) {}

  bool enabled() const { return threshold_ != 0; }
  bool stalled(uint32_t link, uint64_t cycle) const {
    return threshold_ != 0 && mix(mix(seed_ + link) ^ cycle) < threshold_;
  }

 private:
  uint64_t threshold_ = 0, seed_ = 0;
};

}  // namespace cuboct::emu
