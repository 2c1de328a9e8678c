// SPDX-License-Identifier: MIT
// The gpu engine behind `run` and `crosscheck`: the program cuboct-gpu beside cuboct.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/engines.h"
#include "cli/items.h"
#include "cli/recorder.h"
#include "model/trace/trace.h"

namespace cuboct {

// What the command line says about the gpu engine.
struct GpuChoice {
  int gpus = 0;              // the first so many devices; 0: one
  std::vector<int> devices;  // or these, by CUDA's ordinals
  bool joules = false;       // measure energy; of `run` alone

  void add_to(CLI::App& command);  // --gpus and --devices
  // Throws InputError where an option is given that only the gpu engine has.
  void check_unused(const std::string& engine) const;
};

struct GpuRequest : Request {
  std::string precision = "fixed";  // or "float", "double"
  uint64_t hash_every = 0;          // 0: none; of a fixed run alone
  bool watch = false;               // energies are measured then too
  bool energies = true;
  bool forces = false;  // frames in real numbers hold the pair forces
  bool passes = false;  // the trace is read once and dropped: not compressed
};

// The engine at work; see RunningEngine.
RunningEngine start_gpu(const Input& input, const GpuChoice& choice, const GpuRequest& request,
                        std::string path, bool progress);

struct GpuAnswer {
  Trace trace;  // without frames
  Items summary;
  bool failed = false;  // the watch found something
};

// Waits for the run. Ctrl-C gives the run so far. Frames go to the recorder where there is one.
GpuAnswer run_on_gpu(const Input& input, const Loaded& loaded, const GpuChoice& choice,
                     const GpuRequest& request, Recorder* recorder);

}  // namespace cuboct
