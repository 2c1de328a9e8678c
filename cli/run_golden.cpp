// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <optional>

#include "cli/engines.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"
#include "model/contract/golden.h"

namespace cuboct {

Trace run_golden(const Setup& setup, const Request& request, const std::function<void(const State&)>& watch,
                 const std::function<void(const State&)>& keep) {
  using Clock = std::chrono::steady_clock;
  const Plan& plan = setup.plan;
  Trace trace;
  trace.engine = "golden";
  trace.plan_hash = plan.hash;
  trace.nodes = plan.nodes();
  Progress progress("golden", request.steps, plan.particles);
  std::optional<uint64_t> given;
  const auto give = [&](const State& state) {
    given = state.step;
    if (keep)
      keep(state);
    else
      trace.frames.push_back(state);
  };
  const auto record = [&](const State& state) {
    trace.state_hash.push_back(hash_of(plan.lattice, state));
    if (std::binary_search(request.frames.begin(), request.frames.end(), state.step)) give(state);
    if (watch) watch(state);
  };
  State state = setup.initial;
  try {
    Golden golden(plan.rule, plan.lattice, plan.arch.capacity, setup.initial);
    record(state);
    while (golden.step_count() < request.steps && !interrupted()) {
      const auto begin = Clock::now();
      golden.step();
      trace.seconds += std::chrono::duration<double>(Clock::now() - begin).count();
      state = golden.state();
      record(state);
      progress.at(state.step);
    }
  } catch (const RunError& error) {
    trace.stop = StopReason{error.fault, error.step, error.cell, error.particle, error.number, error.what()};
  }
  // The last state is part of every answer, also of a run that ended early.
  if (!trace.state_hash.empty() && !request.frames.empty() && given != state.step) give(state);
  return trace;
}

}  // namespace cuboct
