// SPDX-License-Identifier: MIT
// project.json of an emitted project: what other programs ask of it without reading SystemVerilog.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hw/plan/plan.h"
#include "model/contract/state.h"

namespace cuboct {

// Cycles of a run's first steps, as the machine takes them.
struct CountedCycles {
  uint64_t steps = 0;   // that were counted, at least 1
  uint64_t cycles = 0;  // of all of them
  uint64_t most = 0;    // of one step

  double mean() const { return static_cast<double>(cycles) / static_cast<double>(steps); }
};

// Of the format: what other versions wrote is refused.
inline constexpr uint64_t kProjectVersion = 1;

// JSON, indented by two, keys in fixed order. `files` are the modules' paths in the order to read; expected
// cycles per step are those of hw/cost/cycles.h at the initial state; `counted` stands beside them where
// there is some. docs/reference/synth.md says what each entry is.
std::string print_project(const Plan& plan, const State& initial, const std::vector<std::string>& files,
                          const std::optional<CountedCycles>& counted);

}  // namespace cuboct
