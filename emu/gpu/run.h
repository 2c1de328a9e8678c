// SPDX-License-Identifier: MIT
// The gpu engine behind the interface of all engines.
#pragma once

#include <functional>
#include <vector>

#include "emu/gpu/engine.h"
#include "emu/gpu/rounds/rounds_engine.h"
#include "model/run/record.h"

namespace cuboct::gpu {

// Who measures beside a run; each may be empty.
struct Hooks {
  std::function<void()> ready;                            // the engine is made, the devices do nothing
  std::function<void(uint64_t steps)> did;                // a batch is done: that many steps
  std::function<void(cuboct::Counters&, Notes&)> finish;  // the last step is done
};

struct GpuChoice {
  Arithmetic arithmetic = Arithmetic::fixed;
  Options engine;
  Hooks hooks;
  bool interpret = false;  // a rule of text, rather than to compile it
};

// Of rules of text, with its code where cuboct keeps what it can make again; none: they are interpreted.
CompileRounds rounds_compiler(bool interpret);

// InputError of a checkpoint that the run cannot go on from.
[[noreturn]] void refuse_another(const CheckpointReader& from);

// `plan` is the scene's. References are kept.
// Counters of the trace: the engine's own (Counters) and those of the hooks.
EngineKind gpu_kind(const Scene& scene, const Plan& plan, const GpuChoice& choice);

// A whole run.
struct GpuRun : RunRequest {
  Arithmetic arithmetic = Arithmetic::fixed;
  Options engine;
  Hooks hooks;
};
Recorded run_gpu(const Scene& scene, const Plan& plan, const GpuRun& request);

// Where a watch looks: a look takes the whole state to the host and sums its forces there. All of `probes` up
// to some 5e7 particles in all, else about 5 of them, evenly spread. The last state of a run is looked at
// anyway.
std::vector<uint64_t> watch_steps(const std::vector<uint64_t>& probes, uint64_t particles);

}  // namespace cuboct::gpu
