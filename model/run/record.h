// SPDX-License-Identifier: MIT
// The one loop of a run: advance, hash, keep frames, read probes, watch, save, stop. Every engine's trace is
// made here.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "model/run/checkpoint.h"
#include "model/run/engine.h"
#include "model/run/run_log.h"
#include "model/scene/scene.h"
#include "model/trace/curve_readings.h"

namespace cuboct {

// Where checkpoints go and when. Beside FILE lies FILE.journal, the trace so far.
struct CheckpointPlan {
  std::string path;          // empty: none
  uint64_t every_steps = 0;  // 0: not by steps
  double every_seconds = 0;  // of host time; 0: not by time
  bool resume = false;       // go on from `path`
};

// "1000 steps", "30 s", "5 min" or "2 h" into `plan`; InputError for anything else.
void read_interval(const std::string& text, CheckpointPlan& plan);

// To be called once the trace is safe: a finished run leaves no checkpoint.
void remove_checkpoint(const std::string& path);

struct RunRequest {
  uint64_t steps = 0;
  std::vector<uint64_t> frames;  // steps whose states are kept, ascending; the last one too where any are
  std::vector<uint64_t> probes;  // steps at which the scene's probes are read, ascending
  // Takes the kept states as they come, those before a checkpoint again; without one the trace holds them.
  std::function<void(const RunState&)> keep;
  // Takes what is read as it comes, before the state of the same step is kept.
  TakeReading read;
  bool energies = false;  // read with the probes, and at the last state
  // Of the probes' steps, those at which energies are read, ascending; empty: all.
  std::vector<uint64_t> energy_steps;
  bool watch = false;     // look for what fails wherever energies are read (model/analysis/watch.h)
  bool cycles = false;    // keep phase times, where the engine has them
  bool integers = false;  // frames are those of Engine::integers
  bool forces = false;    // frames in real numbers hold the pair forces
  bool totals = false;    // Recorded::momentum_change and largest_speed
  bool until = false;     // end where the scene's `until` holds
  bool last = true;       // the last state's hash, frame and readings, wherever a run ends
  uint64_t hash_every =
      1;  // of fixed engines: the state's hash each so many steps and at the last one; 0: none
  LogRows log = LogRows::off;  // on stderr
  CheckpointPlan checkpoint;
};

// A run's engine, as far as it is known before there is one.
struct EngineKind {
  std::string name;  // Trace::engine
  uint64_t plan_hash = 0, nodes = 0, particles = 0;
  int rounds = 1;           // of the rule, as phase times count them
  bool fixed = true;        // or in real numbers
  bool floats = false;      // in real numbers: of 32 bits
  bool displaced = false;   // the rule holds particles by force: their displacements count
  double table_error = 0;   // N, largest error of the force that a table makes
  int threads = 0;          // that look at states
  bool keeps_state = true;  // through a step that fails
  // Steps are done in batches, else one at a time is asked for.
  bool batches = false;
  bool in_pieces = false;                 // no batch is to take long, whoever looks on
  bool hashes_come = false;               // with a batch, after each of its steps
  bool saves = false;                     // leaves checkpoints
  bool deforms = false;                   // follows the scene's box where that changes its lengths
  bool relaxes = false;                   // the scene's static loading: no other engine runs such a scene
  std::function<Vec3(uint32_t)> initial;  // m, from where a particle's displacement counts
  // Of the steps at which energies are read, those at which the watch looks; empty: at all.
  std::function<std::vector<uint64_t>(const std::vector<uint64_t>&)> looks;
  // From the start, or from a checkpoint; `cycles`: with its timing. Throws RunError where a cell would hold
  // more than its capacity.
  std::function<std::unique_ptr<Engine>(CheckpointReader* from, bool cycles)> make;
};

struct Recorded {
  Trace trace;  // where the run stopped or was interrupted: up to the last complete step; with what was found
  double momentum_change = 0;  // of all particles: LSB of the axis that changed most, or kg m/s
  double largest_speed = 0;    // cells per step
  uint64_t resumed_at = 0;     // step of the checkpoint
  bool interrupted = false;
  bool left_checkpoint = false;  // of the last state, of an interrupted run
  std::string trouble;           // what could not be written; empty: nothing
};

// Heeds model/base/interrupt.h: a checkpoint is written where one is planned. A step that cannot be done ends
// the trace with a stop reason. Throws InputError for a checkpoint that is not this run's, or a file that
// cannot be written.
Recorded record(const Scene& scene, const EngineKind& kind, const RunRequest& request);

// The steps at which a request asks for states; and whether it asks for the last one, wherever the run ends.
std::vector<uint64_t> asked_steps(const RunRequest& request);
bool asks_for_last(const RunRequest& request);

// A kept state goes to who takes it, else into the trace.
void give(const RunRequest& request, RunState state, Trace& trace);

// Totals travel from a program to another as counters of the trace.
void put_totals(Recorded& run);
void take_totals(Recorded& run);

}  // namespace cuboct
