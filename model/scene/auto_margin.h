// SPDX-License-Identifier: MIT
// [reach] margin = "auto": cells for what the scene's motion tells (model/analysis/motion_reach.h).
#pragma once

#include "model/scene/scene.h"

namespace cuboct {

// What Scene::reach_margin then is along each axis.
inline constexpr double kAutoMargin = -2;
inline bool has_auto_margin(const Scene& scene) { return scene.reach_margin[0] == kAutoMargin; }

}  // namespace cuboct
