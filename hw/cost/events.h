// SPDX-License-Identifier: MIT
// What a machine does in a run, as counts of events: what its energy and its bounds are made of. Exact where
// its cycles are (emu/timing/timing.h). docs/reference/events.md tells each.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "model/trace/trace.h"

namespace cuboct {

// Of one node, or summed over nodes.
struct MachineEvents {
  uint64_t steps = 0;       // steps, times nodes
  uint64_t updates = 0;     // particles advanced
  uint64_t candidates = 0;  // (record, pass) presented to the filter: each meets all lanes
  // Of these, those whose record came over a link along an axis; the rest are own particles.
  uint64_t candidates_x = 0, candidates_y = 0, candidates_z = 0;
  uint64_t entries = 0;       // of these, with hits: pushed into the queue (narrow memories: none)
  uint64_t issues = 0;        // cycles that issued a pair, of each streamer
  uint64_t pairs = 0;         // issued to a pipe
  uint64_t kicks = 0;         // of these, nearer than the cutoff: added to a sum (emu/timing/kicks.h)
  uint64_t queue_stalls = 0;  // cycles in which a full queue (narrow memories: a busy pipe) held the streamer
  uint64_t relayed = 0;       // records that the node read to send them on, own ones included
  uint64_t relayed_own = 0;   // of these, own ones
  uint64_t halos_x = 0, halos_y = 0, halos_z = 0;  // records that came over its links along an axis
  uint64_t tested = 0;  // of these, tested against the box of the own particles (halos on arrival)
  uint64_t culled_x = 0, culled_y = 0, culled_z = 0;  // of these, left out, by the axis of their link
  uint64_t moved = 0;                                 // particles that came over its links
  uint64_t left = 0;                                  // particles that left over its links
  uint64_t inner = 0;    // particles that went from one of its cells to another (bricks)
  uint64_t scanned = 0;  // slots that SCAN read; it writes those that stay
  uint64_t beats = 0;    // loaded into its link registers, end beats included
  std::array<uint64_t, kPhases> phase_cycles{};  // cycles of its phases; FORCE's run beside others

  MachineEvents& operator+=(const MachineEvents& other);
  bool operator==(const MachineEvents&) const = default;
};

// A count's name in files and tables, and the count.
struct NamedEvent {
  const char* name;
  uint64_t MachineEvents::*count;
};
std::span<const NamedEvent> event_names();

// halos_x, candidates_x, ...
uint64_t& halos_along(MachineEvents& events, int axis);
uint64_t& candidates_along(MachineEvents& events, int axis);
uint64_t& culled_along(MachineEvents& events, int axis);

MachineEvents sum(std::span<const MachineEvents> nodes);

}  // namespace cuboct
