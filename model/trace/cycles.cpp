// SPDX-License-Identifier: MIT
#include "model/trace/cycles.h"

#include <algorithm>

namespace cuboct {

std::optional<CyclesPerStep> cycles_per_step(const Trace& trace) {
  const size_t row = trace.nodes * trace.phases();
  if (trace.cycles.empty() || row == 0) return std::nullopt;
  CyclesPerStep result;
  uint64_t before = 0;
  const size_t steps = trace.cycles.size() / row;
  for (size_t step = 0; step < steps; ++step) {
    uint64_t end = 0;
    for (size_t i = step * row; i < (step + 1) * row; ++i) end = std::max(end, trace.cycles[i].end + 1);
    result.max = std::max(result.max, end - before);
    before = end;
  }
  result.mean = static_cast<double>(before) / static_cast<double>(steps);
  return result;
}

std::vector<PhaseCycles> cycles_per_phase(const Trace& trace) {
  std::vector<PhaseCycles> all(trace.phases());
  for (size_t k = 0; k < trace.cycles.size(); ++k) {
    // An empty span ends before it starts.
    const uint64_t length = trace.cycles[k].end + 1 - trace.cycles[k].start;
    PhaseCycles& phase = all[k % all.size()];
    phase.mean += static_cast<double>(length);
    phase.most = std::max(phase.most, length);
  }
  const double rows = static_cast<double>(trace.cycles.size()) / static_cast<double>(all.size());
  for (PhaseCycles& phase : all)
    if (rows > 0) phase.mean /= rows;
  return all;
}

}  // namespace cuboct
