// SPDX-License-Identifier: MIT
// The converged run of a scene in doubles, against which errors are measured, and how far it can be trusted.
#pragma once

#include <string>
#include <vector>

#include "model/figure.h"
#include "study/settings.h"

namespace cuboct::study {

// One rung of the refinement.
struct Rung {
  double dt = 0;                // s
  double cutoff = 0;            // m
  std::vector<double> figures;  // their values
  double trajectory = 0;        // rms distance from the rung before at the horizon, over the pitch
  double change = 0;            // largest relative change of a figure from the rung before
};

struct KeptState {
  double time = 0;  // s
  Body body;        // x, v (at full steps), types
};

struct Truth {
  std::vector<Rung> rungs;        // coarse to fine; the last is the truth
  std::vector<double> figures;    // of the truth
  std::vector<KeptState> states;  // at times from 0 to the horizon: forces are compared there
  KeptState horizon;              // where trajectories are compared
  double lyapunov_time = 0;       // s, infinite where neighbouring runs do not part exponentially
  double floor = 0;               // trajectory error of the truth itself at the horizon, over the pitch
  double largest_frequency = 0;   // rad/s
  bool converged = false;         // else the figures still moved by more than the tolerance at the last rung
};

}  // namespace cuboct::study
