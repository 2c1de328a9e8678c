// SPDX-License-Identifier: MIT
// A rule that is text, in integers: an engine of programs steps it. Positions, velocities and fields that go
// on are those of its state. Its terms in doubles tell forces, energies and other fields where those are
// asked for.
#pragma once

#include "model/program/integer_program.h"
#include "model/run/integer_engine.h"
#include "model/run/rounds_run.h"

namespace cuboct {

// Where a program's integers stand: references that outlive the engine.
struct ProgramSetting {
  const IntegerProgram& program;
  const FixedRule& fixed;
  const Lattice& lattice;
  const Vec3& origin;
  int capacity = 0;
};

class IntegerRun final : public RoundsRun {
 public:
  // Golden, where `make` is empty. Throws as that does. From the rule's beginning, or a state as
  // for_each_slot and memory() left it.
  IntegerRun(const Scene& scene, const ProgramSetting& setting, const State& from,
             const MakeIntegerEngine& make = {});

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override;
  uint64_t hash() override { return program_->hash(); }
  Momentum momentum() override;
  double largest_speed() override;
  Counters counters() override { return program_->counters(); }
  std::vector<PhaseSpan> phase_times() override { return program_->phase_times(); }
  std::optional<double> seconds() override { return program_->seconds(); }
  Counters counters_of_state() override;
  Notes notes() override;
  RunState integers() override { return program_->state(); }
  Reading read(const Asked& asked) override;
  RunState frame(bool forces) override;
  const Body* saved_body() override;
  bool leads() const override { return program_->leads(); }
  std::pair<bool, bool> agreed(bool stop, bool save) override { return program_->agreed(stop, save); }
  void for_each_slot(const std::function<void(const Particle&)>& see) override {
    program_->for_each_slot(see);
  }
  // The fields of all particles by id, then the numbers of all bonds, then the engine's clocks.
  EngineMemory memory() override;

 private:
  void renew() override;
  void follow(RealEngine& reference) override;
  std::vector<Vec3> velocities(const std::vector<Vec3>& force) override;
  std::vector<std::vector<double>> fields() override;
  // What the process that leads cannot read, no other goes on from.
  template <typename Work>
  auto together(const Work& work);
  ProgramSetting setting_;
  std::unique_ptr<IntegerEngine> program_;
  std::vector<int64_t> field_numbers_, bond_numbers_;  // of body(), as of State
  std::vector<Int3> next_velocities_;                  // of body(), while it is read
  double fastest_ = 0;  // m/s, along an axis, of the states that were looked at
};

// The scene's body in integers, with the rule's fields as they begin, or as Body::bonds kept them.
State program_beginning(const Scene& scene, const ProgramSetting& setting);
// What a checkpoint keeps of a state besides its particles: EngineMemory::own.
std::vector<uint64_t> program_memory(const State& state);
// Its words. Behind them EngineMemory::own has IntegerEngine::clocks.
size_t program_words(const IntegerProgram& program, size_t particles);
// The state that a checkpoint holds: `particles` in the order of their slots, `memory` as IntegerRun left it.
State state_of_checkpoint(State particles, const IntegerProgram& program,
                          const std::vector<uint64_t>& memory);

}  // namespace cuboct
