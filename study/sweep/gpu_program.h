// SPDX-License-Identifier: MIT
// The GPU engine, a program of its own beside the running one (docs/reference/gpu.md): started on a scene's
// text, it leaves a trace.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/trace/trace.h"
#include "study/sweep/settings.h"

namespace cuboct::study {

// Its path. InputError where none stands beside this program.
std::string gpu_program();

// The device that runs are done on, as "NVIDIA H100 80GB HBM3"; empty where there is no program or no device:
// `why` then says which, in one line.
std::string find_gpu(std::string& why);

struct GpuRequest {
  double dt = 0;               // s
  uint64_t scene_steps = 0;    // of the whole run, which a fixed plan knows
  uint64_t steps = 0;          // to do
  uint64_t probe_every = 0;    // steps between readings of curves; 0: none
  bool energies = false;       // among the curves
  bool forces = false;         // pair forces with the states that are kept; engines in real numbers only
  std::vector<uint64_t> keep;  // steps whose states are kept, ascending
};

// A cuboct-gpu that takes runs as they come, and has several of them go on at once on its device. Any thread
// may ask. It ends with this object.
class GpuRuns {
 public:
  // InputError where there is no program. The caller's thread has to outlive this object.
  explicit GpuRuns(int at_once);
  ~GpuRuns();
  GpuRuns(const GpuRuns&) = delete;
  GpuRuns& operator=(const GpuRuns&) = delete;

  // Waits for the run of these words; its exit code. Throws Interrupted, and std::runtime_error where the
  // program has ended.
  int run(const std::vector<std::string>& words);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Runs at once where nobody says how many: four for each core that prepares them, at most 64. As `cuboct-gpu
// many` has it.
int gpu_runs_at_once();

// One run of the case from `start`, its velocities as the engine keeps them: half a step before positions.
// Its states are Trace::frames (fixed) or Trace::bodies. A run that had to stop is a trace with a stop
// reason. Throws InputError where the program refuses the case, Interrupted, and std::runtime_error where it
// fails. `runs`: where it goes on beside others; null: in a program of its own.
Trace run_gpu(const Case& c, const Body& start, const GpuRequest& request, GpuRuns* runs);

// Pair forces of an engine in real numbers on the particles of `body`. N
std::vector<Vec3> gpu_forces(const Case& c, const Body& body, GpuRuns* runs);

// Steps per second of host time, once per repeat of `seconds` or more each: of the whole scene from its
// start, again and again, without what comes before its first step. Empty where the run stops. Errors as of
// run_gpu.
std::vector<double> gpu_rates(const Case& c, const Body& start, const GpuRequest& request, int repeats,
                              double seconds);

}  // namespace cuboct::study
