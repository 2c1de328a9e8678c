// SPDX-License-Identifier: MIT
// The force engine of a node: streamer, filter lanes, queue, issue, pipes. docs/reference/node.md, "Force
// engine".
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/systemc/words.h"
#include "hw/plan.h"

namespace cuboct::emu {

// The least (code, id, number) of a step.
struct FaultKeeper {
  Fault code = Fault::none;
  uint32_t id = 0;
  int64_t number = 0;

  void add(Fault new_code, uint32_t new_id, int64_t new_number);
};

class ForceEngine {
 public:
  static constexpr int kSegments = 1 + kFaces;  // own, -x, +x, -y, +y, -z, +z

  struct Counts {
    uint64_t candidates = 0;    // (record, pass) presented to the filter
    uint64_t pairs_issued = 0;  // that passed the planar test
    uint64_t pairs_inside = 0;  // of these, nearer than the cutoff
    uint64_t stalls = 0;        // cycles in which a full queue held the streamer
    uint64_t issue_cycles = 0;  // cycles that issued a pair
    uint64_t busy = 0;          // cycles from the engine's first to its last
  };

  // The engine reads `own` and `halo` and writes `fault`; all three stay the node's.
  ForceEngine(const Plan& plan, const std::vector<Slot>& own,
              const std::array<std::vector<Candidate>, kFaces>& halo, FaultKeeper& fault);

  void reset();
  // The next cycle is the engine's first.
  void begin();
  bool active() const { return active_; }
  // One cycle; segments below `available` may be read. True in the engine's last cycle.
  bool cycle(int available);
  // Whether the last cycle changed nothing.
  bool quiet() const { return quiet_; }

  // A slot's sum over the pipes, and clears it.
  Int3 take_sum(int slot);
  const Counts& counts() const { return counts_; }

 private:
  struct Entry {
    const Candidate* candidate = nullptr;
    int first_slot = 0;  // pass * L
    uint64_t mask = 0;   // bit l: slot first_slot + l
  };

  uint64_t filter(const Entry& entry, int self) const;
  void issue();
  void present(int available);
  int segment_size(int segment) const;

  const Plan& plan_;
  const std::vector<Slot>& own_;
  const std::array<std::vector<Candidate>, kFaces>& halo_;
  FaultKeeper& fault_;
  const int lanes_, pipes_;

  bool active_ = false, quiet_ = true;
  int segment_ = 0, record_ = 0, pass_ = 0;  // streamer
  bool f0_valid_ = false, f1_valid_ = false;
  Entry f0_, f1_, current_;
  int f0_self_ = -1;          // the candidate's own slot, -1 for a halo record
  std::vector<Entry> queue_;  // a ring
  uint32_t queue_head_ = 0, queue_count_ = 0;
  int drain_ = 0;          // cycles until the last issued pair is in its sum
  std::vector<Int3> sum_;  // by slot, over all pipes: integer sums do not depend on the split
  Counts counts_;
};

}  // namespace cuboct::emu
