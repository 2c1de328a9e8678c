// SPDX-License-Identifier: MIT
// The timing model of nodes that use halos on arrival: docs/reference/node.md, "Halos on arrival", as
// recurrences over records. docs/reference/timing.md derives them. TimingModel (timing.h) stands before it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "emu/lattice/force_time.h"
#include "emu/lattice/migrate_time.h"
#include "emu/lattice/node_force.h"
#include "emu/lattice/slots.h"
#include "hw/events.h"
#include "hw/plan.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

class ArrivalTiming {
 public:
  // As TimingModel's.
  ArrivalTiming(const Plan& plan, int threads);
  void step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans);
  uint64_t cycles(const CellSlots& slots) const;
  std::vector<uint64_t> starts() const { return {start_.begin(), start_.end()}; }
  void resume(std::span<const uint64_t> starts);
  std::span<const MachineEvents> events() const { return events_; }
  const TimingCounters& counters() const { return counters_; }

 private:
  static constexpr int64_t kLongAgo = INT64_MIN / 4;

  // The relay of a node: what asks, what the memories answer, what the links load.
  struct Relay {
    int64_t asked = kLongAgo;   // the last cycle in which it asked, or left a segment
    int64_t loaded = kLongAgo;  // the cycle of the last beat of what the links load
    int64_t beats = 0;          // of what the memories answer; 0: nothing
    int axis = 0;               // that comes next

    // Its next act, at `there` or later.
    void act(int64_t there);
    // Sends what it asked for; the cycle that loads the last beat.
    int64_t send(int64_t beat_count) {
      beats = beat_count;
      return std::max(asked + 1, loaded) + beats;
    }
  };
  // The relay's records, in its order, and its end beats: the cycles that load their last beats.
  struct Sent {
    Relay relay;
    std::vector<int64_t> record;
    std::array<uint32_t, 3> records{};  // that go over the links of an axis
    std::array<int64_t, 3> end{};
  };
  struct Halo {
    int64_t from = 0;  // the cycle in which the streamer may read it
    std::array<int32_t, 3> x{};
  };
  struct Scratch {
    std::array<std::vector<int32_t>, 3> own;  // B fractional bits
    std::vector<Halo> halo;
    std::vector<int64_t> popped;
  };
  // Of a streamer: cycles of its registers.
  struct Stream;

  void begin(const CellSlots& slots, std::span<const Leaving> leaving);
  void relay(int axis, uint32_t n);
  void exchange_to_update(const CellSlots& slots, uint32_t n, Scratch& scratch);
  int64_t force(const CellSlots& slots, uint32_t n, Scratch& scratch);
  void count_records(uint32_t n);
  // The records that come over a face and reach the box [low, high].
  void gather(const CellSlots& slots, uint32_t n, int face, const std::array<int32_t, 3>& low,
              const std::array<int32_t, 3>& high, std::vector<Halo>& halo, MachineEvents& events) const;
  bool near(const std::array<int32_t, 3>& own, const std::array<int32_t, 3>& other) const;
  void end_beats(int axis, uint32_t n, int64_t start);
  void take_particles(int axis, uint32_t n);
  uint32_t other(uint32_t n, int face) const { return neighbour_[n][static_cast<size_t>(face)]; }

  const Plan& plan_;
  const uint32_t nodes_;
  const int axes_, threads_, shift_;
  const int64_t halo_beats_, received_;
  std::array<int32_t, 3> planar_{};
  std::vector<std::array<uint32_t, 6>> neighbour_;  // number `nodes_` where there is none
  Migration migration_;

  // Of the step; nodes + 1 where neighbours are asked: the one that does not exist is empty.
  std::vector<uint32_t> count_, final_count_;  // particles at its start, at its end
  std::vector<int64_t> start_;                 // first cycle
  std::vector<Sent> sent_;
  std::array<std::vector<int64_t>, kPhases> end_;                    // the phases' last cycles
  std::array<std::vector<int64_t>, 3> migrate_start_, migrate_end_;  // first cycle; that loads the end beat
  std::vector<Scratch> scratch_;                                     // by thread
  std::vector<MachineEvents> events_;                                // by node
  uint64_t steps_ = 0;
  TimingCounters counters_;
};

}  // namespace cuboct::emu
