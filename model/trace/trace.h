// SPDX-License-Identifier: MIT
// What an engine returns: the only thing that engines share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/contract/state.h"
#include "model/trace/finding.h"

namespace cuboct {

// The named parts of a node's step, in order (the force phase may start earlier, beside the exchange).
enum class Phase : uint8_t {
  exchange_x,
  exchange_y,
  exchange_z,
  force,
  update,
  migrate_x,
  migrate_y,
  migrate_z
};
inline constexpr int kPhases = 8;
const char* to_string(Phase phase);
// Of a rule of several rounds, those before the migrations: they are there once in each round.
inline constexpr int kRoundPhases = 5, kMostRounds = 5;
constexpr int phases_of(int rounds) { return kPhases + (rounds - 1) * kRoundPhases; }
// Number `index` of a step's phases_of(rounds); rounds count from 0.
struct StepPhase {
  Phase kind;
  int round;
};
constexpr StepPhase phase_at(int index, int rounds) {
  const int migrates = rounds * kRoundPhases;
  return index < migrates ? StepPhase{static_cast<Phase>(index % kRoundPhases), index / kRoundPhases}
                          : StepPhase{static_cast<Phase>(index - migrates + kRoundPhases), rounds - 1};
}
constexpr int phase_index(Phase kind, int round, int rounds) {
  const int k = static_cast<int>(kind);
  return k < kRoundPhases ? round * kRoundPhases + k : (rounds - 1) * kRoundPhases + k;
}
// "force", or with several rounds "force 2", which count from 1 there; "migrate_x".
std::string phase_name(int index, int rounds);
// The one that ends a step, in a plan of two or three axes.
constexpr Phase last_phase(int axes) { return axes == 3 ? Phase::migrate_z : Phase::migrate_y; }

// First and last cycle of a phase, counted from the start of the run (cycle 0: the first cycle after start).
// A phase that the plan does not have (exchange_z, migrate_z of a flat one) ends one cycle before it starts,
// between those around it.
struct PhaseSpan {
  uint64_t start = 0, end = 0;
  bool operator==(const PhaseSpan&) const = default;
};

// One measured quantity over the run.
struct Curve {
  std::string name;  // e.g. "grip.force_x"
  std::string unit;  // e.g. "N"
  std::vector<uint64_t> step;
  std::vector<double> value;
};

// A state of a run in real numbers, in SI; the index is the particle's id. Types are the scene's.
struct RealFrame {
  uint64_t step = 0;
  std::vector<Vec3> x, v;   // m, not wrapped into a periodic box; m/s, half a step before the positions
  std::vector<Vec3> force;  // N, of the pairs; empty, or of all particles in each frame of a trace
  std::vector<Vec3> u;      // m, from the anchors; empty where the rule holds none by force
  // What the rule shows of each particle (RuleDeclaration::shown): [field][particle x its numbers].
  std::vector<std::vector<double>> shown{};
};

struct StopReason {
  Fault fault = Fault::none;
  uint64_t step = 0;
  uint32_t cell = 0, particle = 0;  // of a fault of a link: the first cell of the node whose link it is
  int64_t number = 0;
  std::string text;
  bool operator==(const StopReason&) const = default;
};

// The reading that ended a run (Scene::until).
struct Reached {
  std::string curve, side;
  uint64_t step = 0;
  double value = 0, limit = 0;  // in the curve's unit
  bool operator==(const Reached&) const = default;
};

struct TraceHead;

struct Trace {
  std::string engine;  // "golden", "systemc", ...
  uint64_t plan_hash = 0;
  uint64_t nodes = 0;
  // state_hash[k] is that of step k * hash_every; then that of the last step done, where it is no such step.
  // A run that had to stop may lack the latter: an engine whose state went with the step that failed. Empty
  // where the engine hashes nothing.
  std::vector<uint64_t> state_hash;
  uint64_t hash_every = 1;    // >= 1
  uint64_t steps_done = 0;    // read where steps() cannot count state_hash: hash_every above 1, or no hashes
  std::vector<State> frames;  // the states that were asked for, ascending in step
  std::vector<RealFrame> bodies;  // the same of a run in real numbers; one number of particles in all
  // BondState::kept after the last of `bodies`; nothing where bonds are not those of the body as packed.
  std::optional<std::vector<uint64_t>> bonds;
  std::vector<Curve> curves;
  int rounds = 1;  // of the rule, where an engine counts cycles
  // [(step * nodes + node) * phases() + phase]; empty where the engine counts none
  std::vector<PhaseSpan> cycles;
  std::optional<StopReason> stop;  // the run had to stop: after the last complete step
  std::optional<Reached> reached;  // the run ended before its last step, as its scene has it
  std::optional<uint64_t> asked;   // steps that the run was to do, where the file says so
  // Of an engine that watches its own run (model/analysis/watch.h):
  std::vector<Finding> findings;    // in the order in which they came
  std::optional<uint64_t> watched;  // the last step that was looked at; nothing where nobody watched
  // Not compared between engines:
  double seconds = 0;                                      // host time of the steps alone
  std::vector<std::pair<std::string, double>> counters;    // e.g. {"pairs_issued", 123}
  std::vector<std::pair<std::string, std::string>> notes;  // e.g. {"precision", "float"}

  size_t phases() const { return static_cast<size_t>(phases_of(rounds)); }
  uint64_t steps() const {
    return hash_every == 1 && !state_hash.empty() ? state_hash.size() - 1 : steps_done;
  }
  // Of state_hash[k].
  uint64_t hashed_step(size_t k) const { return std::min(k * hash_every, steps()); }
  // How the run ended: "finished", "interrupted" before its last step, or "stopped" by a fault. Nothing where
  // nobody said how long it was to be.
  const char* ended() const;
  // Whether state_hash should hold the state after `step` in a run that ends with step `last`.
  bool hashes(uint64_t step, uint64_t last) const { return step % hash_every == 0 || step == last; }
};

// HDF5; layout in docs/reference/trace.md. Written to a temporary name beside `path`, then renamed: never
// half a file. Same trace, same bytes. `packed`: compressed; a trace that one program hands to another is
// not, as packing millions of particles takes longer than many steps of theirs.
void write_trace(const std::string& path, const Trace& trace, bool packed = true);
Trace read_trace(const std::string& path);

}  // namespace cuboct
