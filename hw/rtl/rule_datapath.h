// SPDX-License-Identifier: MIT
// The modules of a node that are made of a rule of text: what others see of a particle, and what becomes of
// pairs and particles in each round. rtl/rounds/cuboct_rule_core.sv instantiates them; the pipelines are
// those of hw/pipeline.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hw/pipeline/print.h"
#include "hw/plan/plan.h"

namespace cuboct {

// Parameters of cuboct_rule_core beside those that cuboct_pkg has, as text.
std::vector<std::pair<std::string, std::string>> rule_parameters(const Plan& plan);

// cuboct_rule_candidate, cuboct_rule_datapath, and the pipelines with their memories: cuboct_pair_1, ...
// Without their first lines.
std::vector<pipeline::Module> rule_modules(const Plan& plan);

}  // namespace cuboct
