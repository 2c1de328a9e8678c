// SPDX-License-Identifier: MIT
// First and last cycle of each phase of a node, from the last cycles alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/cost/events.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

// A node's spans of a step of `rounds` rounds that began in cycle `start`, from the last cycles of its
// phases, `end[phase][node]`. With `overlap` the force engine begins with its round. Written to `spans`, of
// all nodes, where there is room, and added to the node's events.
inline void write_spans(std::span<PhaseSpan> spans, uint32_t node, int64_t start,
                        std::span<const std::vector<int64_t>> end, int rounds, bool overlap,
                        MachineEvents& events) {
  const int phases = phases_of(rounds);
  auto begin = static_cast<uint64_t>(start);  // of the round
  uint64_t next = begin;
  for (int p = 0; p < phases; ++p) {
    const Phase kind = phase_at(p, rounds).kind;
    if (kind == Phase::exchange_x) begin = next;
    const auto last = static_cast<uint64_t>(end[static_cast<size_t>(p)][node]);
    const PhaseSpan span{kind == Phase::force && overlap ? begin : next, last};
    events.phase_cycles[static_cast<size_t>(kind)] += last + 1 - span.start;
    next = last + 1;
    if (!spans.empty()) spans[size_t{node} * static_cast<size_t>(phases) + static_cast<size_t>(p)] = span;
  }
  ++events.steps;
}

}  // namespace cuboct::emu
