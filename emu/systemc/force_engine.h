// SPDX-License-Identifier: MIT
// The force engine of a node: streamer, filter lanes, queue, issue, pipes. docs/reference/node.md, "Force
// engine".
//
// It sees nothing of the node but the own slots, which rest while it runs, and the halo memories, of which it
// reads a segment only once that is complete. So it need not be stepped beside the main machine: when the
// last segment is there, `run` steps all its cycles at once, register by register, and tells which one is the
// last.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/systemc/force_clock.h"
#include "emu/systemc/words.h"
#include "hw/plan.h"

namespace cuboct::emu {

class ForceEngine {
 public:
  using Counts = ForceCounts;

  // The engine reads `own` and `halo` and writes `fault`; all three stay the node's.
  ForceEngine(const Plan& plan, const std::vector<Slot>& own,
              const std::array<std::vector<Candidate>, kFaces>& halo, FaultKeeper& fault);

  void reset();
  // The engine's first cycle; segment 0 may be read from there on.
  void begin(uint64_t cycle);
  // The cycle from which on the halos of `axis` may be read; in the order of the axes.
  void available(int axis, uint64_t cycle) { available_[axis + 1] = cycle; }
  // All cycles of the step, once all axes are available; the engine's last cycle.
  uint64_t run() { return plan_.arch.narrow_memories ? walk() : stream(); }

  // A slot's sum over the pipes, and clears it.
  Int3 take_sum(int slot);
  const Counts& counts() const { return counts_; }

 private:
  struct Stream;
  uint64_t stream();
  uint64_t walk();  // with narrow memories
  void filter(Stream& stream) const;
  void issue(const Stream& stream, uint32_t entry, uint64_t& mask);
  void meet(const Candidate& j, int slot);

  const Plan& plan_;
  const std::vector<Slot>& own_;
  const std::array<std::vector<Candidate>, kFaces>& halo_;
  FaultKeeper& fault_;
  const int lanes_, pipes_, segments_;
  std::array<uint64_t, 4> available_{};  // own, x, y, z
  std::vector<Int3> sum_;                // by slot, over all pipes: integer sums do not depend on the split
  Counts counts_;
};

}  // namespace cuboct::emu
