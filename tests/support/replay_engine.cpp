// SPDX-License-Identifier: MIT
#include "tests/support/replay_engine.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/trace/compare.h"

namespace cuboct {

void ReplayEngine::advance(uint64_t steps, std::vector<uint64_t>* hashes) {
  const uint64_t end = std::min(step_ + steps, trace_.steps()), wanted = step_ + steps;
  if (hashes)
    for (uint64_t step = step_ + 1; step <= end; ++step) hashes->push_back(trace_.state_hash.at(step));
  step_ = end;
  if (step_ == wanted) return;
  if (trace_.stop) throw StepError(*trace_.stop);
  ended_ = true;
}

std::vector<PhaseSpan> ReplayEngine::phase_times() {
  const auto at = [&](uint64_t step) {
    return trace_.cycles.begin() + static_cast<ptrdiff_t>(std::min(step * row_, trace_.cycles.size()));
  };
  std::vector<PhaseSpan> spans(at(shown_), at(step_));
  shown_ = step_;
  return spans;
}

Counters ReplayEngine::counters() {
  if (step_ == trace_.steps()) return trace_.counters;
  uint64_t end = 0;
  for (size_t k = 0; k < step_ * row_ && k < trace_.cycles.size(); ++k)
    end = std::max(end, trace_.cycles[k].end + 1);
  return {{"cycles", static_cast<double>(end)}};
}

State ReplayEngine::make_state() {
  const State* state = frame_at(trace_, step_);
  if (!state) throw std::logic_error(fmt::format("the trace holds no state of step {}", step_));
  return *state;
}

}  // namespace cuboct
