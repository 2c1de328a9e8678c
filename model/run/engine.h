// SPDX-License-Identifier: MIT
// What a run asks of an engine, whatever computes and wherever: advance, state, hash, readings, counters,
// phase times. model/run/record.h makes a trace of it. The interface knows steps, not what happens in one.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/analysis/reading.h"
#include "model/trace/trace.h"

namespace cuboct {

// A state as a trace holds it: of the fixed rule, or in real numbers.
using RunState = std::variant<State, RealFrame>;

// Sum over the particles: of fixed engines in P+G fractional bits of a cell edge per step, of others in kg
// m/s.
struct Momentum {
  Int3 fixed{};
  Vec3 real = Vec3::Zero();
};

// What an engine counts, by name, and what it says of itself, by name.
using Counters = std::vector<std::pair<std::string, double>>;
using Notes = std::vector<std::pair<std::string, std::string>>;

// What a checkpoint keeps of an engine besides its particles.
struct EngineMemory {
  std::vector<uint64_t> counters;  // of all runs so far
  std::vector<uint64_t> own;       // what the engine alone reads: its nodes' clocks, its machine's memory
};

// A step that cannot be done, of engines that tell it in their own words; the state before it stands.
class StepError : public std::runtime_error {
 public:
  explicit StepError(StopReason reason) : std::runtime_error(reason.text), reason(std::move(reason)) {}
  StopReason reason;
};

class Engine {
 public:
  virtual ~Engine() = default;

  virtual uint64_t step_count() const = 0;
  // Goes `steps` further; with `hashes`, appends the state's hash after each. Throws RunError (fixed) or
  // StepError at the first step that cannot be done. An engine of large batches heeds model/base/interrupt.h
  // and then returns early, after a complete step.
  virtual void advance(uint64_t steps, std::vector<uint64_t>* hashes = nullptr) = 0;

  // Of fixed engines.
  virtual uint64_t hash() { throw std::logic_error("states in real numbers have no hash"); }
  // Frames, readings and counts that need the rounds of a state throw RoundsError (model/rules/rounds_rule.h)
  // where those cannot be run.
  // With `forces`, a frame in real numbers holds the pair forces.
  virtual RunState frame(bool forces) = 0;
  // The same in integers, of an engine that holds them and shows real numbers.
  virtual RunState integers() { return frame(false); }
  virtual Reading read(const Asked& asked) = 0;
  virtual Momentum momentum() = 0;
  // Cells per step, along an axis: over the states that were looked at, or over all.
  virtual double largest_speed() = 0;

  // The phases of the steps since the last call: [(step * nodes + node) * phases + phase]. Empty where the
  // engine counts no cycles.
  virtual std::vector<PhaseSpan> phase_times() { return {}; }
  // Host time of the steps, where the engine knows it better than who waits for them. s
  virtual std::optional<double> seconds() { return std::nullopt; }
  // Of the work of all steps; and of the state, such as its broken bonds.
  virtual Counters counters() = 0;
  virtual Counters counters_of_state() { return {}; }
  virtual Notes notes() { return {}; }

  // Of engines whose state is saved: the particles in the order in which a new engine is to take them.
  virtual void for_each_slot(const std::function<void(const Particle&)>&) {}
  // Of one in real numbers: all particles at once, by id, with what their bonds keep.
  virtual const Body* saved_body() { return nullptr; }
  virtual EngineMemory memory() { return {}; }

  // Of processes that share a scene, all make the same calls; one keeps the trace and the files.
  virtual bool leads() const { return true; }
  // What any of them asks for, all do: to stop, to save.
  virtual std::pair<bool, bool> agreed(bool stop, bool save) { return {stop, save}; }
};

}  // namespace cuboct
