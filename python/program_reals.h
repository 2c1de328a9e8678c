// SPDX-License-Identifier: MIT
// An engine in real numbers that is a program of its own, stepped from outside. Its bits depend on more than
// its particles: each call of advance() is a run of the program that goes on from the checkpoint of the last
// one, and leaves one. So the bits are those of one whole run.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cli/run/engine_options.h"
#include "model/base/output.h"
#include "model/run/engine.h"
#include "python/sources.h"

namespace cuboct::python {

class ProgramReals final : public Engine {
 public:
  // `scene` and `setup` are those of `sources`; references are kept. The engine's row has devices.
  ProgramReals(const Sources& sources, const std::string& engine, const EngineOptions& options,
               const Scene& scene, const Setup& setup);

  uint64_t step_count() const override { return step_; }
  // Starts the program. Throws StepError after the last step that could be done, and again whenever it is
  // asked to go on; InputError where the program was not built; std::runtime_error where it fails. Returns
  // early after an interrupt.
  void advance(uint64_t steps, std::vector<uint64_t>*) override;
  // What the program left. Of it the reference tells the rest, here.
  RunState frame(bool forces) override;
  Reading read(const Asked& asked) override { return here().read(asked); }
  Momentum momentum() override { return here().momentum(); }
  double largest_speed() override { return here().largest_speed(); }
  Counters counters() override { return {}; }
  const Body* saved_body() override { return here().saved_body(); }
  Fields fields();

 private:
  Engine& here();
  void take(const Trace& trace);

  const Sources sources_;
  const std::string engine_;
  EngineOptions options_;
  const Scene& scene_;
  const Setup& setup_;
  const Scratch scratch_;
  const Input input_;
  uint64_t step_ = 0;
  std::optional<RealFrame> left_;  // by the program; none: it has not run
  Body body_;                      // of the state, with its bonds
  std::unique_ptr<Engine> here_;   // at the state, once it is asked
  std::optional<StopReason> stop_;
};

}  // namespace cuboct::python
