// SPDX-License-Identifier: MIT
// project.json of an emitted project: what other programs ask of it without reading SystemVerilog.
#pragma once

#include <string>
#include <vector>

#include "hw/plan.h"
#include "model/contract/state.h"

namespace cuboct {

// JSON, indented by two, keys in fixed order. `files` are the modules' paths in the order to read; cycles per
// step are those of hw/cycles.h at the initial state. docs/reference/synth.md says what each entry is.
std::string print_project(const Plan& plan, const State& initial, const std::vector<std::string>& files);

}  // namespace cuboct
