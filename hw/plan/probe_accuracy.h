// SPDX-License-Identifier: MIT
// What probes are off by in a plan's formats, and the formats that keep what they ask for.
#pragma once

#include <vector>

#include "hw/plan/plan.h"
#include "model/analysis/probe_error.h"

namespace cuboct {

// As model/analysis/probe_error.h; of a rule that is text its fields alone, by its tables and factors.
std::vector<ProbeError> probe_errors(const Scene& scene, const Plan& plan);

// Whether the formats are chosen by a probe's accuracy too. Static loading has none: it runs in doubles.
bool asks_accuracy(const Scene& scene);

// Makes formats and rule of a scene of pairs finer, where a probe asks for an accuracy that they do not keep:
// those of a smaller `accuracy` in the rules of hw/arch/auto_widths.h, halved until the estimates do. What
// the arch sets stays. Reasons name the probe. InputError where none keep it, with the best that can be had.
void refine_for_probes(const Scene& scene, const Arch& arch, const CellEdges& edges, AutoWidths& chosen,
                       FixedRule& rule);

}  // namespace cuboct
