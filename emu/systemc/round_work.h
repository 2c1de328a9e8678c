// SPDX-License-Identifier: MIT
// The rounds of a rule of text in a node of one cell, by golden's own functions: what pairs add to the sums
// of the own slots, and what finishes make of these.
#pragma once

#include <vector>

#include "emu/machine/words.h"
#include "emu/systemc/fault_keeper.h"
#include "hw/plan/plan.h"
#include "model/contract/program_run.h"

namespace cuboct::emu {

class RoundWork {
 public:
  // Keeps references to all; writes `fault`, and bonds of `own`.
  RoundWork(const Plan& plan, std::vector<Slot>& own, FaultKeeper& fault);

  // The force engine of a round begins. Steps count from the node's reset.
  void begin(int round, uint64_t step);
  size_t round() const { return round_; }
  // The own particle in `slot` meets `other`, which stays where it is until add().
  void meet(size_t slot, const Candidate& other) { partners_[slot].push_back(&other); }
  // Adds what all that met make; how many pairs counted.
  uint64_t add();
  // The finish of the round for the particle in a slot, and clears its sums. In the last round the particle
  // moves.
  void finish(Slot& slot, size_t index);

 private:
  struct Round {
    PairRun pair;
    FinishRun finish;
  };
  Seen seen(const Slot& slot, Particle& particle) const;
  // What the particle in slot `k` sees: all that met it, or of a bonded rule these with their bonds.
  void look(size_t k);
  void join(size_t k);

  const Plan& plan_;
  const graph::FixedProgram& program_;
  std::vector<Slot>& own_;
  FaultKeeper& fault_;
  std::vector<Round> rounds_;
  size_t round_ = 0;
  std::vector<std::vector<const Candidate*>> partners_;  // by slot
  std::vector<int64_t> sums_;                            // by slot, then by number of the round's sums
  std::vector<Particle> others_;                         // scratch
  std::vector<Seen> seen_;
  std::vector<bool> met_;  // by place
  uint32_t kinds_ = 1;     // of bonds
};

}  // namespace cuboct::emu
