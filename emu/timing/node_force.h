// SPDX-License-Identifier: MIT
// What is remembered of a node's force engine from step to step. Nothing here is an estimate: what is not
// proved to be the same is computed again. docs/reference/timing.md, "What is remembered".
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "emu/timing/force_time.h"
#include "emu/timing/hits.h"
#include "hw/cost/events.h"

namespace cuboct::emu {

// How often work was saved; for reports and tests.
struct TimingCounters {
  uint64_t busy = 0;      // node-steps of nodes with particles
  uint64_t filtered = 0;  // of those, whose candidates were tested
  uint64_t walked = 0;    // of those, whose queue was followed entry by entry
};

// Adds what the filter and the pipes do in a step. `queued`: there is a queue.
inline void count_work(const ForceWork& work, bool queued, MachineEvents& events) {
  for (size_t segment = 0; segment < work.items.size(); ++segment) {
    events.candidates += work.items[segment];
    if (segment > 0) candidates_along(events, static_cast<int>(segment - 1) / 2) += work.items[segment];
  }
  if (queued) events.entries += work.entries.size();
  for (const uint32_t entry : work.entries) events.issues += entry & ((1u << ForceWork::kCycleBits) - 1);
  events.pairs += work.pairs;
}

class NodeForce {
 public:
  // The engine's last cycle, counted from its first, of `node`, which is not empty. `still`: since the last
  // call no particle of the node or of those around has come, gone or changed its slot, nor has it moved,
  // unless the rule is bonded.
  int64_t time(const Filter& filter, const Places& places, uint32_t node, const ForceShape& shape,
               const Available& available, bool still, HitScratch& scratch, TimingCounters& counters,
               MachineEvents& events) {
    ++counters.busy;
    bool same = still && known_;
    if (!same) {
      ++counters.filtered;
      const ForceWork work = places.rows != nullptr ? filter_bonds(filter, places, node, scratch)
                                                    : filter_node(filter, places, node, scratch);
      same = known_ && work.items == items_ && std::ranges::equal(work.entries, entries_);
      if (!same) {
        items_ = work.items, entries_.assign(work.entries.begin(), work.entries.end());
        work_ = {};
        count_work({items_, entries_}, shape.read == 0, work_);
      }
      work_.pairs = work.pairs;  // entries tell their cycles, not their hits
    }
    // What may be read before the streamer can ask for it may be read from the start: all such times are one.
    Available asked;
    for (size_t a = 0; a < 3; ++a) asked[a] = std::max<int64_t>(available[a], 0);
    if (!same || asked != available_) {
      ++counters.walked;
      known_ = true;
      available_ = asked;
      time_ = force_time(shape, {items_, entries_}, asked, scratch.popped);
    }
    events += work_;
    events.queue_stalls += static_cast<uint64_t>(time_.stalls);
    return time_.last;
  }

 private:
  bool known_ = false;  // what follows is that of the last call
  std::array<uint32_t, kSegments> items_{};
  std::vector<uint32_t> entries_;
  Available available_{};
  ForceTime time_;
  MachineEvents work_;  // of `items_` and `entries_`
};

}  // namespace cuboct::emu
