// SPDX-License-Identifier: MIT
// Words that a machine's memories read and write in a run: its events (hw/cost/events.h), by memory.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/cost/events.h"
#include "hw/plan/plan.h"

namespace cuboct {

struct MemoryTraffic {
  std::string holds;  // "own particles": a memory of each node
  uint64_t words = 0;
  int bits = 0;    // of a word
  int copies = 1;  // that a node has, be it one per pipe or one per face
  // Summed over the copies. A word that goes to several copies is written several times. Reads are those
  // whose word is used: what an enabled port reads beside is not counted.
  uint64_t reads = 0, writes = 0;
  bool counted = true;  // false: no event tells; reads and writes are 0 and mean nothing
};

// Of one node's events, or of their sum over nodes. Loading and dumping are left out. With narrow memories a
// word is a record, though it is read in several. What a brick's relay reads of the halos of x and y is told
// of those of y.
std::vector<MemoryTraffic> memory_traffic(const Plan& plan, const MachineEvents& events);

}  // namespace cuboct
