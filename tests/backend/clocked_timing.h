// SPDX-License-Identifier: MIT
// The timing model beside the native node stepped clock by clock, on one case.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "emu/timing/slots.h"
#include "model/contract/golden.h"
#include "tests/support/cases.h"

namespace cuboct::test {

// What the stimuli contained.
struct Seen {
  uint64_t spans = 0, runs = 0, faults = 0;
  uint64_t stalls = 0;       // cycles in which a full queue held a streamer
  uint64_t multi_pass = 0;   // cell-steps with more own particles than lanes
  uint64_t multi_beat = 0;   // steps of plans whose records take several beats
  uint64_t empty_cells = 0;  // cell-steps
  uint64_t full_cells = 0;   // cell-steps that hold the capacity
  uint64_t leave = 0;        // particles that leave their cell in a step
  uint64_t leave_twice = 0;  // along two axes, so that an arrival leaves again
  uint64_t leave_thrice = 0;
  uint64_t crowds = 0;                          // cell-steps in which several particles leave one cell
  uint64_t emptied = 0;                         // cells that hold particles before a step and none after
  uint64_t busy = 0, filtered = 0, walked = 0;  // TimingCounters
  uint64_t checked = 0;
  uint64_t no_overlap = 0, queue_of_one = 0, pipes = 0, pd = 0, weighted = 0, damped = 0, rings_of_3 = 0,
           lone_nodes = 0, flat = 0, shared = 0, coarse = 0, narrow = 0, serial = 0, bricks = 0, arrival = 0,
           streamers = 0;
  // With several devices: runs, and in them links that are cut, of how many intervals and latencies.
  uint64_t boards = 0, cut = 0, serial_links = 0, late_links = 0;
  std::map<std::string, uint64_t> events;
};

emu::CellSlots slots_of(const FixedRule& rule, const Golden& golden);

// Runs both, compares every phase span and count, and adds what the run contained; the text of the first
// difference.
std::string difference(const Case& c, Seen& seen, int threads = 1);

// The same scene and rule on another machine: everything of the arch that only changes cycles is drawn anew,
// but for [boards]. The capacity is sometimes what the fullest cell holds.
Case rebuilt(Case c, uint64_t seed);

// The same on several devices, whose sizes and links are drawn; without checks of links.
Case on_boards(Case c, uint64_t seed);

}  // namespace cuboct::test
