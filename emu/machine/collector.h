// SPDX-License-Identifier: MIT
// Makes a Trace of what the nodes show, cycle by cycle. Knows nothing of SystemC.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <vector>

#include "emu/machine/shown.h"
#include "emu/machine/wire_faults.h"
#include "hw/plan/plan.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

struct RunOptions {
  uint64_t steps = 0;
  std::vector<uint64_t> frames;  // steps whose states are kept, in any order; those beyond `steps` never come
  double stall_rate = 0;         // share of cycles in which a link passes nothing, [0, 1)
  uint64_t stall_seed = 1;
  FaultOptions faults;  // on the wires
  // Takes the states that are kept, ascending in step, once all nodes have shown theirs. Without it the trace
  // holds them.
  std::function<void(State)> take{};
  int threads = 0;          // that step nodes; 0: one per core. No bit and no cycle depends on it
  bool keep_last = false;   // keep the state after the last complete step too
  bool keep_order = false;  // keep the ids in the order of the slots, per step and cell
  uint64_t patience =
      0;  // cycles without any event after which the run is stuck; 0: `patience_of(plan, ...)`
};

// More cycles than any phase of this plan can take, stalls included.
uint64_t patience_of(const Plan& plan, double stall_rate);

// A particle as the load port takes it: its word, and the cell of a brick.
struct Loaded {
  Word word;
  uint32_t cell = 0;
};
// The particles by physical node, in the order in which they are loaded: by cell, within a cell by id. Throws
// RunError where a cell would hold more than its capacity.
std::vector<std::vector<Loaded>> by_node(const Plan& plan, const State& initial);
// The host's control of a cycle that loads number `k` of a node's particles, or nothing more.
void load(const std::vector<Loaded>& particles, size_t k, Control& control);

class Collector {
 public:
  // Keeps a reference to `plan`.
  Collector(const Plan& plan, const RunOptions& options);

  // Whether `out` shows anything that `collect` must see; `collect` may be skipped where it does not.
  static bool shows(const NodeOutputs& out) {
    return (out.phase_start | out.phase_end) != 0 || out.observe || out.fault || out.idle;
  }
  // One cycle of one physical node; cycles count from the start of the run. To be called for each cycle of a
  // node in order, and for all nodes with a cycle before the next one. Throws std::runtime_error for a
  // particle that the plan does not have, as an unchecked link may make one.
  void collect(uint32_t node, uint64_t cycle, const NodeOutputs& out);

  // All steps are complete, or all nodes have finished the first step with a fault, or a link has failed:
  // then the nodes around it wait for ever. Nothing may be collected any more.
  bool done() const { return done_; }
  // The run ends here: the trace is that of the steps that all nodes have done.
  void break_off(uint64_t cycle);
  uint64_t steps_done() const { return trace_.state_hash.empty() ? 0 : trace_.state_hash.size() - 1; }
  uint64_t last_event() const { return last_event_; }  // cycle
  uint64_t last_cycle() const { return last_cycle_; }  // of the run, once done
  // [step][cell]: ids in the order of the slots, if asked for.
  const std::vector<std::vector<std::vector<uint32_t>>>& order() const { return order_; }
  // So far: a hash for each step that all nodes have shown, and the spans of those before it.
  const Trace& trace() const { return trace_; }
  // Valid once done. `engine`, `seconds` and the counters are the caller's.
  Trace take_trace();

 private:
  struct Snapshot {
    State state;        // of frames, and of what may be the last step
    bool kept = false;  // a frame
    uint64_t hash = 0;
    uint32_t complete = 0;  // nodes that have shown all of it
  };
  Snapshot& snapshot(uint64_t step);
  void observe(uint32_t node, const NodeOutputs& out);
  uint32_t cell_of(uint32_t node, uint32_t local) const;
  void complete(uint64_t step);
  void keep(State state);
  void close(uint64_t cycle);
  void add_last();

  const Plan& plan_;
  RunOptions options_;  // frames ascending
  const ShownReader reader_;
  const uint32_t nodes_;
  const int rounds_;
  const size_t phases_;    // of a step
  const int shown_phase_;  // with whose end a node has shown its particles
  const int last_phase_;   // of a step
  Trace trace_;
  std::vector<uint64_t> step_;             // per node: the step it is in
  std::vector<bool> stopped_;              // per node: back in IDLE
  std::map<uint64_t, Snapshot> open_;      // states of which a part is still to come
  std::map<uint64_t, uint32_t> finished_;  // nodes that finished a step
  std::deque<State> recent_;               // the last complete ones, ascending, where the last is to be kept
  std::vector<std::vector<std::vector<uint32_t>>> order_;
  StopReason stop_;     // the least (step, stage, fault, id, number) so far
  int stop_stage_ = 0;  // NodeOutputs::fault_stage
  bool done_ = false;
  uint64_t last_event_ = 0, last_cycle_ = 0;
};

}  // namespace cuboct::emu
