// SPDX-License-Identifier: MIT
// The timing model of nodes that use halos on arrival: docs/reference/node.md, "Halos on arrival", as
// recurrences over records. docs/reference/timing.md derives them. TimingModel (timing.h) stands before it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "emu/timing/cycles.h"
#include "emu/timing/node_timing.h"

namespace cuboct::emu {

class ArrivalTiming final : public CellTiming {
 public:
  ArrivalTiming(const Plan& plan, int threads);
  void step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) override;

 private:
  // The relay of a node: what asks, what the memories answer, what the links load.
  struct Relay {
    int64_t asked = kLongAgo;     // the last cycle in which it asked, or left a segment
    int64_t loaded = kLongAgo;    // the cycle of the last beat of what the links load
    int64_t answered = kLongAgo;  // ... of what the memories answer; kLongAgo: nothing

    // Its next act, at `there` or later.
    void act(int64_t there);
    // The first cycle in which the links can load what it asked for.
    int64_t sends() const { return std::max(asked + 1, loaded) + 1; }
  };
  // The relay's records, in its order, and its end beats: the cycles that load their last beats.
  struct Sent {
    Relay relay;
    std::vector<int64_t> record;
    std::array<uint32_t, 3> records{};  // that go over the links of an axis
    std::array<int64_t, 3> end{};
    // By face that leads to another device: the cycles in which the neighbour sees them.
    std::array<std::vector<int64_t>, kFaces> seen;
    std::array<int64_t, kFaces> end_seen{};
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

  void relay(int axis, uint32_t n);
  void exchange_to_update(const CellSlots& slots, uint32_t n, Scratch& scratch);
  int64_t force(const CellSlots& slots, uint32_t n, Scratch& scratch);
  void count_records(uint32_t n);
  // The records that come over a face and reach the box [low, high].
  void gather(const CellSlots& slots, uint32_t n, int face, const std::array<int32_t, 3>& low,
              const std::array<int32_t, 3>& high, std::vector<Halo>& halo, MachineEvents& events) const;
  bool near(const std::array<int32_t, 3>& own, const std::array<int32_t, 3>& other) const;
  // The cycle in which a node sees what its neighbour sends over the neighbour's `face`: a record, the end
  // beat, and those of its migrations.
  int64_t came(uint32_t from, int face, size_t record) const {
    const Sent& sent = sent_[from];
    return links_.cut(from, face) ? sent.seen[static_cast<size_t>(face)][record]
                                  : sent.record[record] + received_;
  }
  int64_t ended(uint32_t from, int face) const {
    const Sent& sent = sent_[from];
    return links_.cut(from, face) ? sent.end_seen[static_cast<size_t>(face)]
                                  : sent.end[static_cast<size_t>(face / 2)] + received_;
  }
  int64_t migrated(uint32_t from, int face) const {
    return links_.cut(from, face) ? links_.seen(from, face)
                                  : migrate_end_[static_cast<size_t>(face / 2)][from] + received_;
  }
  void end_beats(int axis, uint32_t n, int64_t start);
  void take_particles(int axis, uint32_t n);
  uint32_t other(uint32_t n, int face) const { return neighbour_[n][static_cast<size_t>(face)]; }

  const int shift_;
  const int64_t halo_beats_;
  std::array<int32_t, 3> planar_{};

  // Of the step; nodes + 1 where neighbours are asked.
  std::vector<Sent> sent_;
  std::array<std::vector<int64_t>, 3> migrate_start_, migrate_end_;  // first cycle; that loads the end beat
  std::vector<Scratch> scratch_;                                     // by thread
};

}  // namespace cuboct::emu
