// SPDX-License-Identifier: MIT
// What a user can do about a fault that stopped a run.
#pragma once

#include <string>

#include "hw/plan/plan.h"
#include "model/scene/scene.h"
#include "model/trace/trace.h"

namespace cuboct {

// One line: the cell and where it stands, what happened there with its number, and the keys
// of scene or arch that help.
std::string advice_on(const StopReason& stop, const Plan& plan, const Scene& scene);

}  // namespace cuboct
