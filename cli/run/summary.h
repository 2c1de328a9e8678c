// SPDX-License-Identifier: MIT
// The summary that ends a run.
#pragma once

#include <vector>

#include "cli/command.h"
#include "cli/items.h"
#include "model/run/record.h"

namespace cuboct {

// Every curve's last value, and its smallest and largest; of the energies, how much the total changed and its
// last.
void add_curves(Items& items, const Scene& scene, const std::vector<Curve>& curves);

// The reading that ended a run, "at step 9: tip.along is 0.0031 m, above 0.003 m".
std::string reached_text(const Trace& trace);

// Notes of a run that begins elsewhere than with the packing: where. `real`: in real numbers.
void note_start(Trace& trace, const Loaded& loaded, bool real);

// How the run ended, and where if that was too soon.
void add_end(Items& items, const Trace& trace);

// What scene, arch and plan ask for in vain; `real`: of a run in real numbers, which has no formats.
std::vector<std::string> warnings_of(const Loaded& loaded, bool real);

// "warning: ..." lines and the array "warnings". `before`: warnings_of, told before the run.
void add_warnings(Items& items, const std::vector<std::string>& before, const std::vector<Finding>& findings);

// What the run did, from its trace alone.
Items facts_of(const Loaded& loaded, const Trace& trace);

// `real`: of an engine in real numbers.
Items summarise(const Loaded& loaded, const Recorded& run, bool real);

}  // namespace cuboct
