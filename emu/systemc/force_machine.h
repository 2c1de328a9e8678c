// SPDX-License-Identifier: MIT
// What the force engine of any node is to the node: docs/reference/node.md, "Force engine".
//
// It sees nothing of the node but the own slots, which rest while it runs, and the halo memories, of which it
// reads a segment only once that is complete. So it need not be stepped beside the main machine: when the
// last segment is there, `run` steps all its cycles at once, register by register, and tells which one is the
// last.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "emu/machine/words.h"
#include "emu/systemc/fault_keeper.h"
#include "emu/systemc/force_clock.h"
#include "emu/systemc/round_work.h"
#include "hw/plan/plan.h"

namespace cuboct::emu {

class ForceMachine {
 public:
  virtual ~ForceMachine() = default;

  void reset() { std::fill(sum_.begin(), sum_.end(), Int3{}); }
  // The engine's first cycle; segment 0 may be read from there on.
  void begin(uint64_t cycle) { available_.fill(cycle); }
  // The cycle from which on the halos of `axis` may be read; in the order of the axes.
  void available(int axis, uint64_t cycle) { available_[static_cast<size_t>(axis) + 1] = cycle; }
  // All cycles of the step, once all axes are available; the engine's last cycle.
  virtual uint64_t run() = 0;
  // Of a rule of text: the rounds of the node, which is to tell them what begins; else null.
  RoundWork* rounds() { return rounds_.get(); }

  // A slot's sum over the pipes, and clears it. `cell`: of the node's own ones.
  Int3 take_sum(uint32_t cell, size_t slot) { return std::exchange(sum_[cell * capacity_ + slot], Int3{}); }
  const ForceCounts& counts() const { return counts_; }

 protected:
  // Keeps references to both; writes `fault`. `cells`: own cells.
  ForceMachine(const Plan& plan, size_t cells, FaultKeeper& fault)
      : plan_(plan),
        lanes_(static_cast<uint32_t>(plan.arch.filter_lanes)),
        segments_(1 + 2 * plan.rule.axes),
        capacity_(static_cast<size_t>(plan.arch.capacity)),
        fault_(fault),
        sum_(cells * capacity_) {}

  // Adds the pair's kick on the particle in a slot.
  void meet(const Slot& own, uint32_t cell, size_t slot, const Candidate& other) {
    if (rounds_) {
      ++counts_.pairs_issued;
      rounds_->meet(slot, other);
      return;
    }
    const Candidate& i = own.body;
    const PairResult pair = pair_kick(plan_.rule, {i.x[0], i.x[1], i.x[2]}, i.v, i.type,
                                      {other.x[0], other.x[1], other.x[2]}, other.v, other.type);
    ++counts_.pairs_issued;
    counts_.pairs_inside += pair.inside;
    fault_.add(pair.fault, own.body.id, pair.number, cell);
    Int3& sum = sum_[cell * capacity_ + slot];
    for (size_t a = 0; a < 3; ++a) sum[a] += pair.kick[a];
  }

  // From a pair's issue to its sum.
  int pipe() const { return plan_.rounds[rounds_ ? rounds_->round() : 0].pipe; }

  const Plan& plan_;
  const uint32_t lanes_;
  const int segments_;
  std::array<uint64_t, 4> available_{};  // own, x, y, z
  ForceCounts counts_;
  std::unique_ptr<RoundWork> rounds_;

 private:
  const size_t capacity_;
  FaultKeeper& fault_;
  std::vector<Int3> sum_;  // [cell * capacity + slot], over all pipes: integer sums depend on no order
};

}  // namespace cuboct::emu
