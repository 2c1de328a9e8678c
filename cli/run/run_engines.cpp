// SPDX-License-Identifier: MIT
#include "cli/run/run_engines.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/run/engine_run.h"
#include "hw/engine/engines.h"
#include "model/trace/compare.h"

namespace cuboct {

std::vector<Trace> run_all(const SharedRun& run, const std::vector<std::string>& engines,
                           const RunRequest& request) {
  const bool counted = run.input.stall_rate == 0 && run.input.faults.empty() && run.choice.ranks == 1 &&
                       std::ranges::any_of(engines, [](auto& name) { return engine_row(name).cycles; });
  std::vector<EngineRun> runs;
  for (const std::string& engine : engines) {
    RunRequest asked = request;
    asked.cycles = counted && engine_row(engine).counts_if_asked;
    runs.emplace_back(engine, run.input, run.loaded, run.choice, std::move(asked),
                      run.directory + "/" + engine + ".h5", false);
  }
  std::vector<Trace> traces(engines.size());
  for (const bool here : {true, false})
    for (size_t i = 0; i < engines.size(); ++i)
      if ((engine_row(engines[i]).here != Here::none) == here) traces[i] = runs[i].finish().trace;
  return traces;
}

std::string explain(const SharedRun& run, const std::string& engine_a, const std::string& engine_b,
                    uint64_t step) {
  RunRequest request;
  request.steps = step;
  request.integers = run.loaded.setup.plan.program != nullptr;
  if (step > 0) request.frames.push_back(step - 1);
  request.frames.push_back(step);
  const std::vector<Trace> again = run_all(run, {engine_a, engine_b}, request);
  for (const uint64_t at : request.frames) {
    const State *a = frame_at(again[0], at), *b = frame_at(again[1], at);
    if (!a || !b) return fmt::format("{} recorded no state of step {}", a ? engine_b : engine_a, at);
    if (const auto mismatch = compare(*a, *b))
      return mismatch->text(engine_a, engine_b, run.loaded.setup.plan.lattice);
  }
  return fmt::format(
      "the states of step {} are equal when run again: one of the engines is not deterministic, or "
      "computes its hashes wrong",
      step);
}

}  // namespace cuboct
