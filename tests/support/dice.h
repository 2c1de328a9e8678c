// SPDX-License-Identifier: MIT
// Random draws that are the same on every machine.
#pragma once

#include <cstdint>
#include <random>

namespace cuboct::test {

class Dice {
 public:
  explicit Dice(uint64_t seed) : random_(seed) {}
  int draw(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<uint64_t>(high - low + 1));
  }
  bool chance(int percent) { return draw(0, 99) < percent; }
  uint64_t bits(int n) { return n == 0 ? 0 : random_() >> (64 - n); }

 private:
  std::mt19937_64 random_;
};

}  // namespace cuboct::test
