// SPDX-License-Identifier: MIT
// The charts of a study of machines, described once for page and gnuplot (study/report/chart.h).
#pragma once

#include <vector>

#include "study/machines/machine_runner.h"
#include "study/machines/peers.h"
#include "study/report/chart.h"

namespace cuboct::study {

struct MachineResults {
  const MachineStudy& study;
  const std::vector<MachineFinding>& findings;
  const std::vector<size_t>& front;
  const std::vector<Peer>& peers;
};

// Those that have something to draw: steps/s and particle-steps/s against energy, area and error; what binds;
// the roof; strong and weak scaling; technologies side by side.
std::vector<Chart> machine_charts(const MachineResults& results);

}  // namespace cuboct::study
