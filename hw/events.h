// SPDX-License-Identifier: MIT
// What a machine does in a run, as counts of events: what its energy and its bounds are made of. Exact where
// its cycles are (emu/lattice/timing.h). docs/reference/events.md tells each.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hw/plan.h"
#include "model/trace/trace.h"

namespace cuboct {

// Of one node, or summed over nodes.
struct MachineEvents {
  uint64_t steps = 0;         // steps, times nodes
  uint64_t updates = 0;       // particles advanced
  uint64_t candidates = 0;    // (record, pass) presented to the filter: each meets all lanes
  uint64_t entries = 0;       // of these, with hits: pushed into the queue (narrow memories: none)
  uint64_t issues = 0;        // cycles that issued a pair, of each streamer
  uint64_t pairs = 0;         // issued to a pipe
  uint64_t queue_stalls = 0;  // cycles in which a full queue (narrow memories: a busy pipe) held the streamer
  uint64_t relayed = 0;       // records that the node read to send them on, own ones included
  uint64_t halos = 0;         // records that came over its links
  uint64_t tested = 0;        // of these, tested against the box of the own particles (halos on arrival)
  uint64_t moved = 0;         // particles that came over its links
  uint64_t left = 0;          // particles that left over its links
  uint64_t inner = 0;         // particles that went from one of its cells to another (bricks)
  uint64_t scanned = 0;       // slots that SCAN read; it writes those that stay
  uint64_t beats = 0;         // loaded into its link registers, end beats included
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

MachineEvents sum(std::span<const MachineEvents> nodes);

// Words that a memory of a node reads and writes, of one node or summed.
struct MemoryTraffic {
  std::string holds;  // "own particles": as hw/node_memories.h names it
  uint64_t words = 0;
  int bits = 0;                    // of a word
  int copies = 1;                  // all are written together; reads are summed over them
  uint64_t reads = 0, writes = 0;  // words; a write is counted once per copy
};

}  // namespace cuboct
