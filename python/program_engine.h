// SPDX-License-Identifier: MIT
// An engine in a program of its own that is stepped from outside. Each advance() is a run of the program that
// begins with the state reached so far, as `cuboct run --from` does: the bits are those of one whole run.
#pragma once

#include <string>

#include "cli/run/engine_options.h"
#include "model/base/process.h"
#include "model/run/state_engine.h"
#include "python/sources.h"

namespace cuboct::python {

class ProgramEngine : public StateEngine {
 public:
  // `scene` and `setup` are those of `sources`; references are kept.
  ProgramEngine(const Sources& sources, const std::string& engine, const EngineOptions& options,
                const Scene& scene, const Setup& setup);

  uint64_t step_count() const override { return state_.step; }
  // Starts the program once; more often where a particle leaves the cells of the whole run, to find the step.
  // Throws StepError after the last step that could be done, InputError where the program was not built, or
  // where its machine's formats are others and would round the state. Returns early after an interrupt.
  void advance(uint64_t steps, std::vector<uint64_t>*) override;
  Counters counters() override { return {}; }

 protected:
  State make_state() override { return state_; }

 private:
  Loaded going_on();
  void leave_state() const;
  bool take(State state, const Lattice& theirs, StopReason& lost);

  const Sources sources_;
  const std::string engine_;
  const EngineOptions options_;
  const Scene& scene_;
  const Setup& setup_;
  const Scratch scratch_;
  Input input_;  // its `from` is the directory of the state
  State state_;
};

}  // namespace cuboct::python
