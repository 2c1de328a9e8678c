// SPDX-License-Identifier: MIT
// A rule of text in an engine that is a program: each call of advance() is a run of its own, which goes on
// from the state that the last one left.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/run/engine_options.h"
#include "model/base/output.h"
#include "model/run/integer_engine.h"
#include "python/sources.h"

namespace cuboct::python {

class ProgramIntegers final : public IntegerEngine {
 public:
  // `scene` and `plan` are those of `sources`; references are kept. `initial`: their beginning.
  ProgramIntegers(const Sources& sources, const std::string& engine, const EngineOptions& options,
                  const Scene& scene, const Plan& plan, const State& initial);

  // Starts the program. Throws RunError, the same as golden's; InputError where the program was not built, or
  // would round the state; std::runtime_error where it fails. Returns early after an interrupt.
  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override;
  uint64_t step_count() const override { return state_.step; }
  State state() const override { return state_; }
  uint64_t hash() const override { return hash_; }
  // Of the lattice engine, here.
  std::vector<Int3> next_velocities() override;
  void for_each_slot(const std::function<void(const Particle&)>& see) const override {
    for (const Particle& particle : state_.particles) see(particle);
  }

 private:
  Loaded going_on();
  bool take(const RealFrame& frame, const std::vector<uint64_t>& bonds, uint64_t hash);
  void step_by_golden();

  const Sources sources_;
  const std::string engine_;
  const EngineOptions options_;
  const Scene& scene_;
  const Plan& plan_;
  const Scratch scratch_;
  Input input_;  // its `from` is the directory of the state
  // In it, fields that each step makes anew are not what the program had; its hash counts those it had.
  State state_;
  uint64_t hash_;
  // The same as the program left it: what its next run begins with.
  std::optional<RealFrame> left_;
  std::vector<uint64_t> bonds_;
};

}  // namespace cuboct::python
