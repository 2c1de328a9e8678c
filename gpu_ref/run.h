// SPDX-License-Identifier: MIT
// A run of the gpu engine from its first step to its trace.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "gpu_ref/engine.h"
#include "model/trace/trace.h"

namespace cuboct::gpu {

// Who measures beside a run; each may be empty.
struct Hooks {
  std::function<void()> ready;              // the engine is made, the devices do nothing
  std::function<void(uint64_t steps)> did;  // a batch is done: that many steps
  std::function<void(Trace&)> finish;       // the last step is done: for counters and notes
};

struct GpuRun {
  Arithmetic arithmetic = Arithmetic::fixed;
  uint64_t steps = 0;
  std::vector<uint64_t> frames;  // steps whose states are kept, ascending; the last one too where any are
  std::vector<uint64_t> probes;  // steps at which the scene's probes are read, ascending
  bool energies = false;         // and the energies; the last state is then measured too
  bool watch = false;            // look for what fails wherever energies are read, but see looks_of
  bool forces = false;           // frames in real numbers hold the pair forces
  bool totals = false;           // counters momentum_change and largest_speed: whole states at both ends
  uint64_t hash_every = 1;       // fixed: the state's hash each so many steps and at the last one
  bool progress = false;         // a line per second on stderr where that is no terminal
  Options engine;
  Hooks hooks;
};

struct GpuResult {
  Trace trace;  // where the run stopped or was interrupted: up to the last complete step
  bool interrupted = false;
};

// `plan` is the scene's. Heeds model/base/interrupt.h.
// Counters of the trace, beside the engine's own (Counters), where `totals`:
//   momentum_change  of the whole body: fixed LSB (P+G fractional bits), of the axis that changed most; real
//                    kg m/s, length of the vector
//   largest_speed    cells per step, along an axis, over the states that were measured
GpuResult run_gpu(const Scene& scene, const Plan& plan, const GpuRun& request);

// Where a watch looks: a look takes the whole state to the host and sums its forces there. All of `probes` up
// to some 5e7 particles in all, else about 5 of them, evenly spread. The last state of a run is looked at
// anyway.
std::vector<uint64_t> looks_of(const std::vector<uint64_t>& probes, uint64_t particles);

}  // namespace cuboct::gpu
