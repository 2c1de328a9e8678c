// SPDX-License-Identifier: MIT
#include "emu/machine/machine_engine.h"

#include <fmt/format.h>

#include <algorithm>

#include "hw/engine/engine_kind.h"

namespace cuboct::emu {
namespace {

RunOptions handing_over(RunOptions options, std::deque<State>& to) {
  options.take = [&to](State state) { to.push_back(std::move(state)); };
  return options;
}

}  // namespace

MachineRun::MachineRun(const Plan& plan, const State& initial, const RunOptions& options,
                       const NodeFactory& nodes, const std::string& engine)
    : steps_(options.steps),
      row_(spans_of_step(plan)),
      bench_("bench", plan, initial, handing_over(options, ahead_), nodes, engine),
      clock_({&bench_}) {
  reach(0);
  if (!trace().state_hash.empty()) return;
  if (trace().stop) throw StepError(*trace().stop);
  throw std::runtime_error("interrupted before all nodes held the initial state");
}

void MachineRun::reach(uint64_t step) {
  // The run's last step ends with the bench, whose counts are then whole.
  while (!result_ && (trace().state_hash.size() <= step || step == steps_)) {
    clock_.go_on();
    if (bench_.over()) result_ = bench_.take_result().trace;
  }
}

void MachineRun::advance(uint64_t steps, std::vector<uint64_t>* hashes) {
  const uint64_t wanted = step_ + steps;
  reach(wanted);
  const uint64_t end = std::min(wanted, trace().steps());
  if (hashes)
    for (uint64_t step = step_ + 1; step <= end; ++step) hashes->push_back(trace().state_hash.at(step));
  step_ = end;
  while (!ahead_.empty() && ahead_.front().step < step_) ahead_.pop_front();
  if (step_ == wanted) return;
  if (trace().stop) throw StepError(*trace().stop);
  ended_ = true;
}

std::vector<PhaseSpan> MachineRun::phase_times() {
  const std::vector<PhaseSpan>& cycles = trace().cycles;
  const auto at = [&](uint64_t step) {
    return cycles.begin() + static_cast<ptrdiff_t>(std::min(step * row_, cycles.size()));
  };
  std::vector<PhaseSpan> spans(at(told_), at(step_));
  told_ = step_;
  return spans;
}

Counters MachineRun::counters() const {
  if (result_ && step_ == result_->steps()) return result_->counters;
  const std::vector<PhaseSpan>& cycles = trace().cycles;
  uint64_t end = 0;
  for (size_t k = 0; k < step_ * row_ && k < cycles.size(); ++k) end = std::max(end, cycles[k].end + 1);
  return {{"cycles", static_cast<double>(end)}};
}

const State& MachineRun::state() const {
  const auto state = std::ranges::find(ahead_, step_, &State::step);
  if (state == ahead_.end()) throw std::logic_error(fmt::format("the bench kept no state of step {}", step_));
  return *state;
}

std::vector<Int3> MachineIntegers::next_velocities() {
  return golden_of(plan_, run_.state()).next_velocities();
}

}  // namespace cuboct::emu
