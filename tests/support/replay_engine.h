// SPDX-License-Identifier: MIT
// A run that is over, as an engine: what left a trace without having measured it is measured from its frames.
#pragma once

#include "model/run/record.h"
#include "model/run/state_engine.h"

namespace cuboct {

class ReplayEngine : public StateEngine {
 public:
  // `trace`: with the hash after each step, and a frame wherever a state will be asked for.
  ReplayEngine(const FixedSetting& setting, Trace trace)
      : StateEngine(setting), trace_(std::move(trace)), row_(trace_.nodes * kPhases) {}

  uint64_t step_count() const override { return step_; }
  // Throws StepError at the trace's stop; returns early where it was interrupted.
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override;
  uint64_t hash() override { return trace_.state_hash.at(step_); }
  std::vector<PhaseSpan> phase_times() override;
  std::optional<double> seconds() override { return trace_.seconds; }
  // Of a run that is replayed in part, the cycles up to its last phase alone: other counts are of the whole.
  Counters counters() override;
  Notes notes() override { return trace_.notes; }
  // What interrupts this program has interrupted the run already: all that was done is still replayed.
  std::pair<bool, bool> agreed(bool, bool) override { return {ended_, false}; }

 protected:
  State make_state() override;

 private:
  Trace trace_;
  size_t row_;
  bool ended_ = false;
  uint64_t step_ = 0, shown_ = 0;  // shown: steps whose phases were given
};

}  // namespace cuboct
