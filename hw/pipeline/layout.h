// SPDX-License-Identifier: MIT
// Which bits of which step somebody reads in which cycle: registers and wires of a pipeline.
#pragma once

#include <bitset>
#include <map>
#include <vector>

#include "hw/pipeline/schedule.h"

namespace cuboct::pipeline {

inline constexpr int kMostBits = 192;  // of a step: 63 bits, shifted by up to 124 places
using Bits = std::bitset<kMostBits>;

struct Layout {
  // By step, by cycle: what is read. An empty map: nobody needs the step.
  std::vector<std::map<int, Bits>> read;

  // The last cycle in which a step's value is read; it has a register for each cycle after its own.
  int last(int step) const { return read[static_cast<size_t>(step)].rbegin()->first; }
  // What a register has to hold in a cycle: what is read then or later.
  Bits held(int step, int cycle) const;
};

Layout layout_of(const Schedule& schedule);

// The cycle in which a step takes its inputs.
int start_of(const Schedule& schedule, int step);

}  // namespace cuboct::pipeline
