// SPDX-License-Identifier: MIT
// The force engine of a node with a brick: one streamer walks the own cells and the candidates of each;
// lanes, queue, issue and pipes are those of any node. docs/reference/node.md, "Bricks".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/systemc/force_clock.h"

namespace cuboct::emu {

// What a node with a brick holds.
struct BrickCells {
  std::vector<std::vector<Slot>> own;        // [local]
  std::vector<std::vector<Candidate>> halo;  // [grid]; coordinates in the record's own cell
};

class BrickForce {
 public:
  // Keeps references to all four; writes `fault`.
  BrickForce(const Plan& plan, const BrickWalk& walk, const BrickCells& cells, FaultKeeper& fault);

  void reset();
  // As those of ForceEngine.
  void begin(uint64_t cycle) { available_.fill(cycle); }
  void available(int axis, uint64_t cycle) { available_[static_cast<size_t>(axis) + 1] = cycle; }
  uint64_t run();
  Int3 take_sum(uint32_t local, size_t slot);
  const ForceCounts& counts() const { return counts_; }

 private:
  struct Stream;
  void filter(Stream& stream) const;
  void meet(Stream& stream, uint32_t own, const BrickWalk::Near& near) const;
  void issue(const Stream& stream, uint32_t entry, uint64_t& mask);

  const Plan& plan_;
  const BrickWalk& walk_;
  const BrickCells& cells_;
  FaultKeeper& fault_;
  const size_t lanes_, capacity_;
  std::array<uint64_t, 4> available_{};  // own, x, y, z
  std::vector<Int3> sum_;                // [local * capacity + slot]
  ForceCounts counts_;
};

}  // namespace cuboct::emu
