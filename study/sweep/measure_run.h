// SPDX-License-Identifier: MIT
// One run of one case, in any engine, and what a study keeps of it.
#pragma once

#include <string>
#include <vector>

#include "hw/plan/plan.h"
#include "model/trace/trace.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/settings.h"
#include "study/sweep/time_grid.h"

namespace cuboct::study {

class GpuRuns;

struct RunRequest {
  TimeGrid grid;
  uint64_t until = 0;     // the last sample
  bool curves = false;    // of the probes, read at each sample
  bool energies = false;  // energy.kinetic, .potential, .gravity, .total, and the pressure of a box, as well
  std::vector<uint64_t> keep;  // samples whose bodies are kept, ascending
  int threads = 1;             // of the host
  GpuRuns* gpu = nullptr;      // where a run of the gpu engine goes on beside others
};

struct Run {
  double dt = 0;                        // s, as fitted to the grid
  uint64_t steps = 0;                   // done
  std::vector<Curve> curves;            // probes, then energies
  std::vector<Body> kept;               // [as asked for, up to a stop]; positions and velocities
  Vec3 momentum_change = Vec3::Zero();  // kg m/s, from the start to the end
  double momentum_scale = 0;            // kg m/s, sum of |m v| at the end
  std::string stop;                     // why the run ended early: a fault, not finite; empty: it did not
};

// The bodies of all engines start at the same time: where an engine's velocities live half a step before its
// positions, v(0) of the scene is taken back by a(0) dt/2. Without that, trajectories would part in first
// order of dt however good the method.
Body started_body(const Scene& scene, bool half_step_back);

// In integers, of a rule that is text too. InputError for other rules of rounds.
Plan lattice_plan(const Scene& scene, const Arch& arch);

// Heeds model/base/interrupt.h: throws Interrupted. Throws InputError where the settings make no plan.
// Velocities of kept bodies are those of the engine: half a step earlier than positions in semi-implicit
// Euler.
Run run_case(const Case& c, const RunRequest& request);

// Positions apart at one time: root mean square over the particles, m; over images in a periodic box.
double rms_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const Periodic& periodic);

// What lengths are told in: the pitch, without packing the cutoff. m
double length_unit(const Scene& scene);

}  // namespace cuboct::study
