// SPDX-License-Identifier: MIT
// Pairs nearer than the cutoff, which the timing model need not know: its pipes take as long for others.
#pragma once

#include <span>
#include <vector>

#include "hw/cost/events.h"
#include "hw/plan/plan.h"
#include "model/contract/state.h"

namespace cuboct::emu {

class KickCounter {
 public:
  // `plan` must outlive the counter. `threads`: 0 for one per core that the process may use.
  KickCounter(const Plan& plan, int threads);
  // Adds the kicks of the step that begins with these particles, in any order, to `nodes`, the events of each
  // physical node. A pair counts once for each of its particles that can move or be moved.
  void add(std::span<const Particle> particles, std::span<MachineEvents> nodes);

 private:
  struct Body {
    Int3 x;  // visible, in its cell
    int type;
  };
  uint64_t kicks(uint32_t cell) const;

  const Plan& plan_;
  const int threads_;
  std::vector<uint32_t> first_;  // by cell, and one more
  std::vector<Body> bodies_;     // by cell
  std::vector<uint64_t> kicks_;  // by cell
};

}  // namespace cuboct::emu
