// SPDX-License-Identifier: MIT
// What a step will cost the machine, from how many particles each cell holds.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hw/plan/plan.h"
#include "model/contract/state.h"

namespace cuboct {

// How many particles each cell holds, and how many pairs of those of two cells the filter lets pass: by the
// planar test, or of a bonded rule the bonds. The same for every brick and all numbers of lanes and pipes, so
// counted once where plans are compared.
class PairCensus {
 public:
  PairCensus(const Plan& plan, const State& state);
  uint64_t particles(uint32_t cell) const { return particles_[cell]; }
  // With those of the cell at `offset`, -1 ... 1 along each axis.
  uint64_t pairs(uint32_t cell, const std::array<int8_t, 3>& offset) const {
    return pairs_[cell][place(offset)];
  }
  uint64_t pairs(uint32_t cell) const;  // with all of its neighbourhood

 private:
  static size_t place(const std::array<int8_t, 3>& offset) {
    return static_cast<size_t>(offset[0] + 1 + 3 * (offset[1] + 1) + 9 * (offset[2] + 1));
  }

  std::vector<uint64_t> particles_;
  std::vector<std::array<uint32_t, 27>> pairs_;
};

struct ExpectedCycles {
  uint64_t ideal = 0;  // per step: what filter lanes and force pipes of the busiest node need at full use
  uint64_t step =
      0;  // per step: the slowest node's way through the phases of docs/reference/node.md, with none of its
          // particles leaving, no full queue, and neighbours that begin each phase of each round when it does
};

ExpectedCycles expected_cycles(const Plan& plan, const State& state);
// The same, of a plan without narrow memories, with a census of the plan's particles.
ExpectedCycles expected_cycles(const Plan& plan, const PairCensus& census);

}  // namespace cuboct
