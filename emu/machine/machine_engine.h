// SPDX-License-Identifier: MIT
// The bench behind the interface of all engines. Nodes are never all at the same step: the bench runs ahead
// of the step that is asked for until every node has shown it. States that will be asked for are held until
// then.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "emu/machine/bench.h"
#include "model/run/state_engine.h"

namespace cuboct::emu {

class MachineEngine : public StateEngine {
 public:
  // Runs until all nodes hold the initial state. `options.frames`: the steps whose states will be asked for;
  // the last one too, where `keep_last` says so. References of `setting` and `plan` are kept. Throws RunError
  // for an initial state beyond a capacity, StepError where a link failed before, std::runtime_error for a
  // bench that is stuck or interrupted before; advance() throws std::runtime_error for a bench that is stuck.
  MachineEngine(const FixedSetting& setting, const Plan& plan, const State& initial,
                const RunOptions& options, const NodeFactory& nodes, const std::string& engine);

  uint64_t step_count() const override { return step_; }
  // Throws StepError. Returns early where the bench was interrupted, after the last step that all nodes have
  // done.
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override;
  uint64_t hash() override { return trace().state_hash.at(step_); }
  std::vector<PhaseSpan> phase_times() override;
  std::optional<double> seconds() override { return bench_.seconds(); }
  // Of a run that ends before its last step, the cycles alone: other counts include what the bench ran ahead.
  Counters counters() override;
  // An interrupt ends the bench. What all nodes have done by then is still told.
  std::pair<bool, bool> agreed(bool, bool) override { return {ended_, false}; }

 protected:
  State make_state() override;

 private:
  const Trace& trace() const { return result_ ? *result_ : bench_.trace(); }
  // Clocks the bench until all nodes have shown the state after `step`, or to its end.
  void reach(uint64_t step);

  const uint64_t steps_;     // of the run
  const size_t row_;         // spans of a step
  std::deque<State> ahead_;  // kept ones, from the present step on
  Bench bench_;
  BenchClock clock_;
  std::optional<Trace> result_;  // once the bench is over
  bool ended_ = false;
  uint64_t step_ = 0, told_ = 0;  // told: steps whose phases were given
};

}  // namespace cuboct::emu
