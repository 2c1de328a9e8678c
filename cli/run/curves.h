// SPDX-License-Identifier: MIT
// Curves of a run as comma-separated values.
#pragma once

#include <string>
#include <vector>

#include "model/scene/scene.h"
#include "model/trace/trace.h"

namespace cuboct {

// As curves_csv (model/trace/curves_csv.h): without the time where steps are those of static loading, without
// units where the scene's are reduced.
std::string csv_of(const Scene& scene, const std::vector<Curve>& curves);

}  // namespace cuboct
