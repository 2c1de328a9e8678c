// SPDX-License-Identifier: MIT
// What settings cost, independent of any machine and its compiler: transistors at work (hw/cost/node_area.h).
#pragma once

#include "study/sweep/settings.h"

namespace cuboct::study {

// Area times time: a node's transistors, times the interacting pairs of the initial state, each worked on
// from both sides, over its pipes, times the steps per simulated second. Pipes per node are no saving but by
// what they share. Throws InputError where the settings make no plan.
double cost_of(const Case& c);

}  // namespace cuboct::study
