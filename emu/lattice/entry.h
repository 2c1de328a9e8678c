// SPDX-License-Identifier: MIT
// Pairs as lists hold them. Compiled code of rules includes this file too.
#pragma once

#include <cstdint>

namespace cuboct::emu {

// The pairs (group's lane l, particle first + l) for the bits l of `lanes`.
struct Entry {
  int32_t first;
  uint8_t lanes;
  uint8_t shift;  // index into Particles::shift
};
inline constexpr uint8_t kNoShift = 13;

// A group's entries. Those that may meet in the next few steps stand before the others.
struct EntryGroup {
  uint32_t begin;
  uint32_t near, count;
};

}  // namespace cuboct::emu
