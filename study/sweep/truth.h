// SPDX-License-Identifier: MIT
// The converged run of a scene in doubles, against which errors are measured, and how far it can be trusted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/trace/figure.h"
#include "study/sweep/settings.h"
#include "study/sweep/study.h"
#include "study/sweep/time_grid.h"

namespace cuboct::study {

// One rung of the refinement. Velocity Verlet in doubles.
struct Rung {
  double dt = 0;                // s
  double cutoff = 0;            // m
  std::vector<double> figures;  // their values; nan where the run does not hold the figure
  double trajectory = 0;        // rms distance from the rung before at the horizon, over the pitch; nan: none
  double change = 0;            // largest relative change of a figure from the rung before; nan: none
};

struct KeptState {
  double time = 0;  // s
  Body body;        // x, v (at full steps), types
};

struct Truth {
  std::vector<Rung> rungs;         // coarse to fine; then, where the cutoff is lengthened, short to long
  std::vector<double> figures;     // of the truth: the last rung's
  std::vector<KeptState> states;   // at four times up to the horizon: forces are compared there
  KeptState horizon;               // where trajectories are compared, with the scene's own cutoff
  double lyapunov_time = 0;        // s, infinite where neighbouring runs do not part exponentially
  double floor = 0;                // trajectory error of the truth itself at the horizon, over the pitch
  double largest_frequency = 0;    // rad/s; 0 where it is not known (no packing)
  bool converged = false;          // else the figures still moved by more than the tolerance at the last rung
  TimeGrid grid;                   // of the study, with its horizon
  std::vector<std::string> notes;  // what a reader must know: one line each
};

// Refines from the scene's own dt by halves, until every figure changes by less than the study's tolerance
// (relative) and positions at the horizon by less than it (over the pitch), or the rungs are used up. Then,
// where the law is cut off for speed alone (`lj`), lengthens the cutoff by 1.25 until it stops mattering for
// the figures, twelve times at most. Notes where the figures depend on the samples (sampling.h).
//
// The horizon is the sample at which a small difference between two runs has grown by e^3 = 20 since the
// start: three Lyapunov times of a run that parts steadily, the end of a run that does not. Beyond, errors
// tell the run's sensitivity and nothing of the method.
//
// `jobs`: threads at most; no bit depends on them. After each rung `save` is given the truth so far; `begun`,
// such a truth or an empty one, is where the refinement goes on. Throws InputError, Interrupted
// (interrupted.h).
Truth make_truth(const Study& study, int jobs, Truth begun = {},
                 const std::function<void(const Truth&)>& save = {});

// What of some settings changes the physical scene: "" for the study's own, else its changes in one line.
std::string physics_key(const Settings& settings);

// Of a scene with another pitch, cutoff, ...: the truth of its forces and trajectory alone, at the time steps
// (over the largest stable one) and the horizon of `study_truth`. Figures are compared with those of the
// study's truth.
Truth make_own_truth(const Study& study, const Truth& study_truth, const Settings& settings);

}  // namespace cuboct::study
