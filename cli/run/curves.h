// SPDX-License-Identifier: MIT
// Curves of a run as comma-separated values.
#pragma once

#include <optional>

#include "cli/command.h"

namespace cuboct {

// s, from a step of a run's curves to the next; nothing where steps are those of static loading.
std::optional<double> time_step_of(const Loaded& loaded);

}  // namespace cuboct
