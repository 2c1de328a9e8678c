// SPDX-License-Identifier: MIT
// What a scene's motion makes of a run, told before it runs.
#pragma once

#include <string>
#include <vector>

#include "model/scene/scene.h"

namespace cuboct {

// What moves matter faster than its waves travel, in a line each: none can follow, and what is read of it is
// of the grips alone.
std::vector<std::string> motion_warnings(const Scene& scene);

}  // namespace cuboct
