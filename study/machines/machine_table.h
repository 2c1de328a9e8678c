// SPDX-License-Identifier: MIT
// Machines as text.
#pragma once

#include <string>
#include <vector>

#include "study/machines/machine_runner.h"

namespace cuboct::study {

// "cell_edge 1 mm, filter_lanes 4, cmos7, 100 MHz": what a study sets of this machine.
std::string machine_text(const MachineStudy& study, const MachineChoice& choice);

// All machines with all their numbers, tab-separated: one line each, a head with the units. Every number has
// a column that says how it is known, but those of one origin.
std::string machines_tsv(const MachineStudy& study, const std::vector<MachineFinding>& findings,
                         const std::vector<size_t>& front);

// Lines for people: each quantity of a machine with its band and how it is known.
std::string machine_report(const MachineStudy& study, const MachineFinding& finding);

// Lines for people: each constraint, its verdict and its value.
std::string constraints_report(const MachineStudy& study, const MachineFinding& finding);

// Some machines, one a line: cycles, steps/s, energy, power, area, what binds.
std::string machines_lines(const MachineStudy& study, const std::vector<MachineFinding>& findings,
                           const std::vector<size_t>& some);

// Of one machine, for scripts.
std::string machine_json(const MachineStudy& study, const MachineFinding& finding);

}  // namespace cuboct::study
