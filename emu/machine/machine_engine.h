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
#include "model/run/integer_engine.h"
#include "model/run/state_engine.h"

namespace cuboct::emu {

// A bench that is asked for one step after another.
class MachineRun {
 public:
  // Runs until all nodes hold the initial state. `options.frames`: the steps whose states will be asked for;
  // the last one too, where `keep_last` says so. A reference of `plan` is kept. Throws RunError for an
  // initial state beyond a capacity, StepError where a link failed before, std::runtime_error for a bench
  // that is stuck or interrupted before.
  MachineRun(const Plan& plan, const State& initial, const RunOptions& options, const NodeFactory& nodes,
             const std::string& engine);

  uint64_t step_count() const { return step_; }
  // Throws StepError, or std::runtime_error for a bench that is stuck. Returns early where the bench was
  // interrupted, after the last step that all nodes have done.
  void advance(uint64_t steps, std::vector<uint64_t>* hashes);
  uint64_t hash() const { return trace().state_hash.at(step_); }
  std::vector<PhaseSpan> phase_times();
  double seconds() const { return bench_.seconds(); }
  // Of a run that ends before its last step, the cycles alone: other counts include what the bench ran ahead.
  Counters counters() const;
  bool ended() const { return ended_; }  // by an interrupt
  // std::logic_error where nobody said that it will be asked for.
  const State& state() const;

 private:
  const Trace& trace() const { return result_ ? *result_ : bench_.collected(); }
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

// Of the pair law.
class MachineEngine : public StateEngine {
 public:
  // As MachineRun. A reference of `setting` is kept too.
  MachineEngine(const FixedSetting& setting, const Plan& plan, const State& initial,
                const RunOptions& options, const NodeFactory& nodes, const std::string& engine)
      : StateEngine(setting), run_(plan, initial, options, nodes, engine) {}

  uint64_t step_count() const override { return run_.step_count(); }
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override { run_.advance(steps, hashes); }
  uint64_t hash() override { return run_.hash(); }
  std::vector<PhaseSpan> phase_times() override { return run_.phase_times(); }
  std::optional<double> seconds() override { return run_.seconds(); }
  Counters counters() override { return run_.counters(); }
  // An interrupt ends the bench. What all nodes have done by then is still told.
  std::pair<bool, bool> agreed(bool, bool) override { return {run_.ended(), false}; }

 protected:
  State make_state() override { return run_.state(); }

 private:
  MachineRun run_;
};

// Of a rule of text.
class MachineIntegers : public IntegerEngine {
 public:
  MachineIntegers(const Plan& plan, const State& initial, const RunOptions& options, const NodeFactory& nodes,
                  const std::string& engine)
      : plan_(plan), run_(plan, initial, options, nodes, engine) {}

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override { run_.advance(steps, hashes); }
  uint64_t step_count() const override { return run_.step_count(); }
  State state() const override { return run_.state(); }
  uint64_t hash() const override { return run_.hash(); }
  std::vector<Int3> next_velocities() override;
  std::vector<PhaseSpan> phase_times() override { return run_.phase_times(); }
  std::optional<double> seconds() const override { return run_.seconds(); }
  Counters counters() const override { return run_.counters(); }
  std::pair<bool, bool> agreed(bool, bool) override { return {run_.ended(), false}; }

 private:
  const Plan& plan_;
  MachineRun run_;
};

}  // namespace cuboct::emu
