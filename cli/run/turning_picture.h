// SPDX-License-Identifier: MIT
// The particles of a report's last frame on a canvas, which the mouse turns. The page's policy lets this one
// script run, by its hash, and nothing else.
#pragma once

#include <optional>
#include <string>

#include "model/scene/scene.h"
#include "model/trace/frame.h"

namespace cuboct {

// What a policy names the script by: "'sha256-...'".
std::string turning_script_hash();

// A figure with its data and script; empty where no particle has a place. `limit`: of axial strain, where the
// colours end; absent: at the 90th percentile.
std::string turning_picture(const Scene& scene, const Frame& frame, std::optional<double> limit);

}  // namespace cuboct
