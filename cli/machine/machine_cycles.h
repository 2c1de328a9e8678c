// SPDX-License-Identifier: MIT
// What an emitted machine's step takes, counted rather than expected.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hw/cost/events.h"
#include "hw/rtl/rtl_project.h"

namespace cuboct {

// The machine's exact cycles over the first steps of a run from `initial`, by the lattice engine and its
// timing model: kCountedSteps of them, or as many as the run has, fewer where there are very many particles.
// Ends before a step that breaks a width or a capacity; nothing where that is the first.
inline constexpr uint64_t kCountedSteps = 200;
std::optional<CountedCycles> count_cycles(const Plan& plan, const State& initial, uint64_t run_steps);

// The same with what each node did; `steps` of them, fewer where a step breaks something or there is an
// interrupt (model/base/interrupt.h). A terminal shows how far it is, behind `label`.
struct CountedRun {
  CountedCycles cycles;
  std::vector<MachineEvents> nodes;
};
std::optional<CountedRun> count_run(const Plan& plan, const State& initial, uint64_t steps,
                                    const std::string& label = "cycles");

}  // namespace cuboct
