// SPDX-License-Identifier: MIT
// Whether a schedule can be built: a check that shares no code with what makes schedules, or steps.
#pragma once

#include <string>
#include <vector>

#include "hw/pipeline/schedule.h"

namespace cuboct::pipeline {

// Empty, or the first thing that is wrong: a step that reads a value before it is there; steps in a row that
// take longer than the clock's period; an output, or a check, that nothing makes; an output after `cycles`.
std::string refusal_of(const graph::Graph& graph, const std::vector<int>& outputs, const Schedule& schedule,
                       const Delays& delays = kDelays);

}  // namespace cuboct::pipeline
