// SPDX-License-Identifier: MIT
// First and last cycle of each phase of a node, from the last cycles alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/cost/events.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

// A node's spans of a step that began in cycle `start`, from the last cycles of its phases,
// `end[phase][node]`. With `overlap` the force engine begins with the step. Written to `spans`, of all nodes,
// where there is room, and added to the node's events.
inline void write_spans(std::span<PhaseSpan> spans, uint32_t node, int64_t start,
                        const std::array<std::vector<int64_t>, kPhases>& end, bool overlap,
                        MachineEvents& events) {
  std::array<PhaseSpan, kPhases> span;
  const auto begin = static_cast<uint64_t>(start);
  uint64_t next = begin;
  for (size_t p = 0; p < kPhases; ++p) {
    const auto last = static_cast<uint64_t>(end[p][node]);
    span[p] = {p == static_cast<size_t>(Phase::force) && overlap ? begin : next, last};
    events.phase_cycles[p] += last + 1 - span[p].start;
    next = last + 1;
  }
  ++events.steps;
  if (!spans.empty()) std::ranges::copy(span, spans.begin() + std::ptrdiff_t{node} * kPhases);
}

}  // namespace cuboct::emu
