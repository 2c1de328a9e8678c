// SPDX-License-Identifier: MIT
// A run of the lattice engine from its first step, or from a checkpoint, to its trace.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "emu/lattice/engine.h"
#include "model/analysis/watch.h"
#include "model/scene/scene.h"
#include "model/trace/trace.h"

namespace cuboct::emu {

// Where checkpoints go and when. Beside FILE lies FILE.journal, the trace so far.
struct CheckpointPlan {
  std::string path;          // empty: none
  uint64_t every_steps = 0;  // 0: not by steps
  double every_seconds = 0;  // of host time; 0: not by time
  bool resume = false;       // go on from `path`
};

// "1000 steps", "30 s", "5 min" or "2 h" into `plan`; InputError for anything else.
void read_interval(const std::string& text, CheckpointPlan& plan);

struct LatticeRun {
  uint64_t steps = 0;
  std::vector<uint64_t> frames;  // steps whose states are kept, ascending; the last one too where any are
  std::vector<uint64_t> probes;  // steps at which the scene's probes are read, ascending
  // Takes the kept states as they come, those before a checkpoint again; without one the trace holds them.
  std::function<void(const State&)> keep;
  bool energies = false;    // and the energies; the last state is then measured too
  bool watch = false;       // look for what fails wherever energies are read (model/analysis/watch.h)
  bool cycles = false;      // run the timing model
  uint64_t hash_every = 1;  // the state's hash each so many steps and at the last one
  bool progress = false;    // a line per second on stderr where that is no terminal
  LatticeOptions engine;
  CheckpointPlan checkpoint;
  // Where memory is short: the scene's own body, which is used up, and how to get it again if need be.
  Body* spare = nullptr;
  std::function<Body()> body_again;
};

struct LatticeResult {
  Trace trace;  // where the run stopped or was interrupted: up to the last complete step; with what the watch
                // found
  Int3 momentum_before{}, momentum_after{};  // P+G fractional bits, at step 0 and after the last complete one
  double largest_speed = 0;                  // cells per step, over the states that were kept or measured
  uint64_t resumed_at = 0;                   // step of the checkpoint
  bool interrupted = false;
  bool left_checkpoint = false;  // of the last state, of an interrupted run
};

// `plan` is the scene's. The engine loses its state in a step that fails: the last complete state is then
// made again, from the last checkpoint or from the start. Heeds model/base/interrupt.h after each step: a
// checkpoint is written where one is planned. Throws InputError for a checkpoint that is not this run's, or a
// file that cannot be written.
LatticeResult run_lattice(const Scene& scene, const Plan& plan, const LatticeRun& request);

// To be called once the trace is safe: a finished run leaves no checkpoint.
void remove_checkpoint(const std::string& path);

}  // namespace cuboct::emu
