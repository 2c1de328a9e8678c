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

// How the run ended, and where if that was too soon.
void add_end(Items& items, const Trace& trace);

// "warning: ..." lines and the array "warnings". `of_plan`: what the scene or the arch asks for in vain.
void add_warnings(Items& items, const std::vector<std::string>& of_plan,
                  const std::vector<Finding>& findings);

// `real`: of an engine in real numbers.
Items summarise(const Loaded& loaded, const Recorded& run, bool real);

}  // namespace cuboct
