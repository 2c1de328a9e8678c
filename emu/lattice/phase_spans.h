// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "model/trace/trace.h"

namespace cuboct::emu {

// Writes a node's spans of a step that began in cycle `start`, from the last cycles of its phases,
// `end[phase][node]`. With `overlap` the force engine begins with the step.
inline void write_spans(std::span<PhaseSpan> spans, uint32_t node, int64_t start,
                        const std::array<std::vector<int64_t>, kPhases>& end, bool overlap) {
  PhaseSpan* const span = spans.data() + size_t{node} * kPhases;
  const auto begin = static_cast<uint64_t>(start);
  uint64_t next = begin;
  for (size_t p = 0; p < kPhases; ++p) {
    const auto last = static_cast<uint64_t>(end[p][node]);
    span[p] = {p == static_cast<size_t>(Phase::force) && overlap ? begin : next, last};
    next = last + 1;
  }
}

}  // namespace cuboct::emu
