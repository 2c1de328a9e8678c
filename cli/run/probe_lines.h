// SPDX-License-Identifier: MIT
// What `cuboct check` tells of each probe: what integers leave of its curve.
#pragma once

#include <string>
#include <vector>

#include "cli/items.h"
#include "hw/plan/plan.h"
#include "model/analysis/probe_error.h"
#include "model/scene/scene.h"

namespace cuboct {

// Of each probe; none where no integers run the scene.
std::vector<ProbeError> told_errors(const Scene& scene, const Plan& plan);
// "stress within about 0.3 %, strain 0.05 %; the force table at 2 % strain"
std::string error_text(const Scene& scene, const ProbeError& error);

// A line "probe tension" for each, in JSON with its numbers as "errors".
void add_probe_errors(Items& items, const Scene& scene, const Plan& plan);

}  // namespace cuboct
