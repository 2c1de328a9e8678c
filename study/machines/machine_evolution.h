// SPDX-License-Identifier: MIT
// The search of a space that is too large for a grid: NSGA-II of pagmo over the same axes.
// K. Deb et al., A fast and elitist multiobjective genetic algorithm: NSGA-II, IEEE Trans. Evol. Comput.
// 6(2), 2002.
#pragma once

#include <functional>
#include <vector>

#include "study/machines/machine_runner.h"

namespace cuboct::study {

// What pagmo's module is asked for: whole numbers in [0, sizes[k]) on each axis.
struct NotchEvolution {
  std::vector<size_t> sizes;
  size_t objectives = 1;
  unsigned population = 40, generations = 25, seed = 1;
  // Of each point its objectives, less is better: a generation at once, in order.
  std::function<std::vector<std::vector<double>>(const std::vector<std::vector<size_t>>&)> worth;
};
// The caller's exceptions pass through.
using EvolveNotches = void(const NotchEvolution& evolution);
inline constexpr const char* kNotchModule = "cuboct-machine-evolution.so";
inline constexpr const char* kEvolveNotches = "cuboct_evolve_notches";

struct Evolved {
  std::vector<MachineFinding> front;  // of all that were looked at, counted for the study's steps
  size_t visited = 0;                 // different machines
};

// Screens by `kScreenSteps` counted steps. Those on the front of all that were looked at are then counted for
// the study's steps, and again what is on the front with them, until all of it is exact. A machine that
// breaks a constraint stands behind those that do not, by how far it misses. The same study gives the same
// machines. InputError where the module is missing.
inline constexpr uint64_t kScreenSteps = 5;
Evolved evolve_machines(const MachineStudy& study, MachineRunner& runner);

}  // namespace cuboct::study
