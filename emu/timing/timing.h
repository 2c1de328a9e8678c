// SPDX-License-Identifier: MIT
// The exact cycles of a run without stalls, at the price of a few operations per node and step: the contract
// of docs/reference/node.md as recurrences over nodes and their neighbours. docs/reference/timing.md derives
// them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "emu/timing/node_force.h"
#include "emu/timing/slots.h"
#include "hw/cost/events.h"
#include "hw/plan/plan.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

class NodeTiming;

class TimingModel {
 public:
  // `threads`: 0 for one per core that the process may use. `plan` must outlive the model.
  TimingModel(const Plan& plan, int threads);
  ~TimingModel();
  TimingModel(const TimingModel&) = delete;
  TimingModel& operator=(const TimingModel&) = delete;

  // The next step: `slots` are the particles at its start by cell of the lattice, `leaving` those that leave
  // their cell in it, in any order. The step must be one that ends without a fault. spans[node * phases +
  // phase], of physical nodes, gets first and last cycle, cycle 0 being the first of the run; empty where
  // nobody wants them. Throws std::invalid_argument, and is of no use after, where sizes do not fit the plan,
  // a cell holds more than its capacity or not what the step before left there, or a particle leaves the
  // lattice.
  void step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans);

  // Cycles of the run if it ends after the steps so far, DUMP and the last node's first cycle of IDLE
  // included: what the cycle-accurate engines count. `slots` are the particles then.
  uint64_t cycles(const CellSlots& slots) const;

  // All that later steps depend on: the cycle, by node, at which the next step begins; with several devices
  // then what the links between them do.
  std::vector<uint64_t> starts() const;
  // Goes on from there. Throws std::invalid_argument where the size is another.
  void resume(std::span<const uint64_t> starts);

  // Of all steps so far, by node; of a model that resumed, those since then. Without kicks (kicks.h).
  std::span<const MachineEvents> events() const;
  const TimingCounters& counters() const;

 private:
  std::unique_ptr<NodeTiming> nodes_;
};

}  // namespace cuboct::emu
