// SPDX-License-Identifier: MIT
// Particles as the machine keeps them: cell by cell, slot by slot.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace cuboct::emu {

struct CellSlots {
  std::vector<uint32_t> first;            // cells + 1: cell n holds [first[n], first[n+1])
  std::array<std::vector<int32_t>, 3> x;  // P fractional bits, in [0, 2^P)
  std::vector<uint32_t> id;               // of a bonded rule, whose hits do not depend on x
};

// A particle that left its cell in a step.
struct Crossing {
  uint32_t particle;  // index or id, as said
  std::array<int8_t, 3> away;
};

// The same, for the timing model: `slot` at the step's start, `away` cells per axis (-1, 0, +1).
struct Leaving {
  uint32_t cell;
  uint32_t slot;
  std::array<int8_t, 3> away;
};

}  // namespace cuboct::emu
