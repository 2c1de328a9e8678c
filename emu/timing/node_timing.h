// SPDX-License-Identifier: MIT
// What the timing models of all kinds of nodes share: the particles of a step, the cycles in which nodes
// begin it, the links between devices. TimingModel (timing.h) stands before them.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "emu/timing/device_links.h"
#include "emu/timing/migrate_time.h"
#include "emu/timing/node_force.h"
#include "emu/timing/slots.h"
#include "hw/cost/events.h"
#include "hw/plan/plan.h"
#include "model/base/parallel.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

class NodeTiming {
 public:
  virtual ~NodeTiming() = default;
  NodeTiming(const NodeTiming&) = delete;
  NodeTiming& operator=(const NodeTiming&) = delete;

  // As TimingModel's.
  virtual void step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) = 0;
  uint64_t cycles(const CellSlots& slots) const;
  std::vector<uint64_t> starts() const;
  void resume(std::span<const uint64_t> starts);
  std::span<const MachineEvents> events() const { return events_; }
  const TimingCounters& counters() const { return counters_; }

 protected:
  NodeTiming(const Plan& plan, int threads);
  // Checks what a step is given, and takes the number of particles of each cell: at its end as at its start.
  void take(const CellSlots& slots, std::span<const Leaving> leaving, std::span<const PhaseSpan> spans);
  // Cycles of a walk over the node's own slots; `first` as of CellSlots.
  virtual int64_t walk(uint32_t n, const uint32_t* first) const = 0;

  const Plan& plan_;
  const uint32_t cells_, nodes_;
  const int axes_, threads_;
  const int64_t received_;
  DeviceLinks links_;
  // Of the step, by cell: particles at its start, at its end. The last one does not exist, and is empty.
  std::vector<uint32_t> count_, final_count_;
  std::vector<int64_t> start_;             // by node: its first cycle. The last one does not exist
  std::vector<std::vector<int64_t>> end_;  // by phase and node: the last cycle
  std::vector<MachineEvents> events_;      // by node
  uint64_t steps_ = 0;
  TimingCounters counters_;
};

// Of nodes that serve one cell each.
class CellTiming : public NodeTiming {
 protected:
  // `answered`: cycles until a particle that was received is seen.
  CellTiming(const Plan& plan, int threads, int64_t answered);
  // What moves in the step: final_count_ is then that of its end.
  void plan_migration(std::span<const Leaving> leaving);
  int64_t walk(uint32_t n, const uint32_t* first) const override {
    return std::max<int64_t>(1, first[n + 1] - first[n]);
  }
  // The first cycle after SCAN: a cycle for each slot, and loads for what leaves.
  int64_t scanned(int axis, uint32_t n, int64_t start);

  // part(node) of all nodes.
  template <class Part>
  void for_all(int threads, const Part& part) const {
    const auto range = [&](size_t from, size_t to) {
      for (size_t n = from; n < to; ++n) part(static_cast<uint32_t>(n));
    };
    for_each_range(nodes_, 1, range, threads);
  }
  // The same with the thread's number. Busy nodes cost many times what empty ones do: small shares, on
  // demand.
  template <class Part>
  void for_all_busy(int threads, const Part& part) const {
    const int64_t nodes = nodes_, share = std::clamp<int64_t>(nodes / (16 * threads), 1, 64);
    for_each_part(static_cast<size_t>((nodes + share - 1) / share), threads, [&](size_t k, int member) {
      const auto first = static_cast<int64_t>(k) * share;
      for (int64_t n = first; n < std::min(nodes, first + share); ++n) part(static_cast<uint32_t>(n), member);
    });
  }

  const int64_t answered_;
  std::vector<std::array<uint32_t, 6>> neighbour_;  // nodes + 1; number `nodes_` where there is none
  Migration migration_;
  std::array<std::vector<int64_t>, 3> seen_;  // with several devices: [axis][departure] when it is seen
};

}  // namespace cuboct::emu
