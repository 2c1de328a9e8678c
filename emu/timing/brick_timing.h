// SPDX-License-Identifier: MIT
// The timing model of nodes that serve bricks of cells: docs/reference/node.md, "Bricks", as recurrences over
// nodes and their neighbours. TimingModel (timing.h) stands before it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "emu/timing/hits.h"
#include "emu/timing/node_timing.h"

namespace cuboct::emu {

// What moves in a step's three migrations, by node: cycles of SCAN and LAND.
class BrickMigration {
 public:
  explicit BrickMigration(const Plan& plan);
  // `count`: particles by cell at the step's start, and after the call those at its end. Throws
  // std::invalid_argument where a particle leaves the lattice.
  void plan(std::vector<uint32_t>& count, std::span<const Leaving> leaving, const BrickMap& map);
  // 0 where no own particle leaves its cell; where none comes to one.
  int64_t scan(int axis, uint32_t node) const { return any_ ? scan_[static_cast<size_t>(axis)][node] : 0; }
  int64_t land(int axis, uint32_t node) const { return any_ ? land_[static_cast<size_t>(axis)][node] : 0; }
  // Whether the step over this face of a cell leaves its brick.
  bool crosses(uint32_t cell, int face) const;
  // Adds what the migrations of the planned step do to a node.
  void count(uint32_t node, MachineEvents& events) const {
    if (any_) events += events_[node];
  }

 private:
  struct Mover {
    uint32_t cell;
    std::array<int8_t, 3> away;  // axes still to go
  };
  void move(int axis, std::vector<uint32_t>& count, const BrickMap& map);

  const Plan& plan_;
  bool any_ = false;
  std::vector<Mover> movers_;
  std::vector<uint8_t> leaving_;   // [cell] bit a: `leaving_a`
  std::vector<uint32_t> arrived_;  // [cell] along the axis at hand
  std::array<std::vector<int64_t>, 3> scan_, land_;
  std::vector<MachineEvents> events_;  // by node
};

class BrickTiming final : public NodeTiming {
 public:
  BrickTiming(const Plan& plan, int threads);
  void step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) override;

 private:
  struct Scratch {
    std::array<std::vector<int32_t>, 3> own;  // of a cell, B fractional bits
    std::vector<uint32_t> entries;
    std::vector<int64_t> popped;
    uint64_t pairs = 0;                      // of a step: hits
    std::array<uint64_t, kSegments> idle{};  // ... items that meet nobody
  };

  void begin(std::span<const Leaving> leaving);
  void send(int axis, uint32_t n);
  int64_t exchanged(int axis, uint32_t n) const;
  int64_t load_layer(uint8_t faces, int face, uint32_t n, int64_t start);
  int64_t scanned(int axis, uint32_t n, int64_t start);
  int64_t ended(int64_t end, uint32_t near, int face) const;
  // Records of the layer that goes over a face; `own`: those of own cells alone.
  uint64_t layer_records(int face, uint32_t n, bool own) const;
  int64_t walk(uint32_t n, const uint32_t* first) const override;
  void exchange_to_update(const CellSlots& slots, uint32_t n, Scratch& scratch);
  int64_t force(const CellSlots& slots, uint32_t n, Scratch& scratch);
  void count_records(uint32_t n);
  void meet(const CellSlots& slots, uint32_t cell, const std::array<int8_t, 3>& offset, bool same,
            uint32_t& item, Scratch& scratch) const;
  void take_particles(int axis, uint32_t n);
  void finish(uint32_t n, std::span<PhaseSpan> spans);

  const BrickMap map_;
  const int64_t halo_beats_;
  const ForceShape shape_;
  const Filter filter_;
  BrickMigration migration_;
  // With several devices: the slots of what leaves a cell, as if each cell were a node, and each cell's
  // particles at the step's end.
  Migration by_cell_;
  std::vector<uint32_t> by_cell_count_;

  std::vector<std::array<int64_t, kFaces>> halo_end_;  // by node and face: the cycle that loads the end beat
  std::vector<std::array<int64_t, 3>> sent_;           // ... the last of them, by axis
  std::array<std::vector<int64_t>, 3> migrate_end_;    // [axis][node]
  std::vector<Scratch> scratch_;                       // by thread
};

}  // namespace cuboct::emu
