// SPDX-License-Identifier: MIT
// An engine of any program of integers, as IntegerRun steps it. All hold golden's bits.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "model/contract/golden.h"
#include "model/run/engine.h"

namespace cuboct {

class IntegerEngine {
 public:
  virtual ~IntegerEngine() = default;
  // As Engine::advance: throws RunError, the same as golden's.
  virtual void advance(uint64_t steps, std::vector<uint64_t>* hashes) = 0;
  virtual uint64_t step_count() const = 0;
  virtual State state() const = 0;  // sorted by id
  virtual uint64_t hash() const = 0;
  // As Golden's; of processes that share a scene one has them.
  virtual std::vector<Int3> next_velocities() = 0;
  // Particles by cell, then slot; by id where golden's slots are not kept.
  virtual void for_each_slot(const std::function<void(const Particle&)>& see) const {
    for (const Particle& particle : state().particles) see(particle);
  }
  virtual Counters counters() const { return {}; }
  virtual std::vector<PhaseSpan> phase_times() { return {}; }
  // Of an engine that counts cycles: by node those at which its next step begins, for a checkpoint.
  virtual std::vector<uint64_t> clocks() const { return {}; }
  virtual std::optional<double> seconds() const { return std::nullopt; }
  // As Engine's: of processes that share a scene one has the whole state, the others an empty one.
  virtual bool leads() const { return true; }
  virtual std::pair<bool, bool> agreed(bool stop, bool save) { return {stop, save}; }
  virtual Notes notes() const { return {}; }  // after counters()
};

// From a state whose particles take the slots of their cells in its order, with their fields in the same.
using MakeIntegerEngine = std::function<std::unique_ptr<IntegerEngine>(const State&)>;

class GoldenIntegers final : public IntegerEngine {
 public:
  GoldenIntegers(const graph::FixedProgram& program, const Lattice& lattice, int capacity,
                 const State& initial, std::shared_ptr<const graph::BondRows> rows = nullptr)
      : lattice_(lattice), golden_(program, lattice, capacity, initial, std::move(rows)) {}

  void advance(uint64_t steps, std::vector<uint64_t>* hashes) override {
    for (; steps > 0; --steps) {
      golden_.step();
      if (hashes != nullptr) hashes->push_back(hash());
    }
  }
  uint64_t step_count() const override { return golden_.step_count(); }
  State state() const override { return golden_.state(); }
  uint64_t hash() const override { return hash_of(lattice_, golden_.state()); }
  std::vector<Int3> next_velocities() override { return golden_.next_velocities(); }
  void for_each_slot(const std::function<void(const Particle&)>& see) const override {
    for (const auto& cell : golden_.cells())
      for (const Particle& particle : cell) see(particle);
  }

 private:
  const Lattice& lattice_;
  Golden golden_;
};

}  // namespace cuboct
