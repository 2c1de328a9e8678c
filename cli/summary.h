// SPDX-License-Identifier: MIT
// What a run's states add up to, and the summary that ends a run.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "cli/command.h"
#include "cli/items.h"
#include "model/analysis/state_meter.h"
#include "model/base/steps.h"
#include "model/trace/trace.h"

namespace cuboct {

// What a summary says beyond the trace.
struct RunFacts {
  Int3 momentum_before{}, momentum_after{};  // P+G fractional bits
  double largest_speed = 0;                  // cells per step, over the states that were looked at
  std::vector<Curve> curves;                 // energy.total among them
  bool watch = false;                        // whether anyone looked for failures
  std::vector<Finding> findings;             // what was found
  std::optional<uint64_t> watched;           // the last step that was looked at
};

// Watches the states of a run: probe curves at the probe steps, energies there and at the last state, largest
// speed.
class RunMeter {
 public:
  RunMeter(const Loaded& loaded, std::vector<uint64_t> probe_steps, bool watch);

  void see(const State& state);
  // Measures the last state too, where it was no probe step. To be called once.
  RunFacts finish();

 private:
  const Loaded& loaded_;
  std::set<uint64_t> probe_steps_;
  StateMeter meter_;
  State last_;
  bool any_ = false, measured_ = false;
  RunFacts facts_;
};

// Cycles that the machine takes per step: from the end of its slowest node in one step to that in the next.
struct CyclesPerStep {
  double mean = 0;
  uint64_t max = 0;
};
std::optional<CyclesPerStep> cycles_per_step(const Trace& trace);

// Every curve's last value, and its smallest and largest; of the energies, how much the total changed and its
// last.
void add_curves(Items& items, const Scene& scene, const std::vector<Curve>& curves);

// How the run ended, and where if that was too soon.
void add_end(Items& items, const Trace& trace);

// "warning: ..." lines and the array "warnings". `of_plan`: what the scene or the arch asks for in vain.
void add_warnings(Items& items, const std::vector<std::string>& of_plan,
                  const std::vector<Finding>& findings);

Items summarise(const Loaded& loaded, const Trace& trace, const RunFacts& facts);

}  // namespace cuboct
