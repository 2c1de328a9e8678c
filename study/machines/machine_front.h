// SPDX-License-Identifier: MIT
// Which machines are worth building: the front of the objectives, the one to choose, the nearest to
// constraints that none keeps.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "study/machines/machine_runner.h"

namespace cuboct::study {

// Whether `a` is no worse than `b` in each objective and better in one. In one technology two machines share
// each figure's error: their bands are compared end by end. Bands of different technologies are compared as a
// whole, so that none is better within them. What is not known is neither.
bool dominates(const MachineStudy& study, const MachineFinding& a, const MachineFinding& b);

// Those that are done, break no constraint and that no other such machine dominates, in their order. Of
// equals in one technology the first stands for all.
std::vector<size_t> machine_front(const MachineStudy& study, const std::vector<MachineFinding>& findings);

// Of those that keep every constraint with the whole of their bands: the least high end of the first
// objective, then of the others, then the first. `undecided`: of those that keep or may keep all.
std::optional<size_t> best_machine(const MachineStudy& study, const std::vector<MachineFinding>& findings,
                                   Verdict worst = Verdict::holds);

// The machine whose worst constraint is missed by least.
std::optional<size_t> nearest_machine(const MachineStudy& study, const std::vector<MachineFinding>& findings);

}  // namespace cuboct::study
