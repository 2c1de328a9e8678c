// SPDX-License-Identifier: MIT
// A run that starts elsewhere than its scene says: studies start all integrators at one time, and ask for
// forces at positions of theirs.
#pragma once

#include <string>

#include "model/scene/scene.h"

namespace cuboct::gpu {

// Positions and velocities (half a step before them) of the last of the trace's `bodies` become the scene's.
// Throws InputError where the trace has none, or one of other particles.
void start_from(const std::string& trace, Scene& scene);

}  // namespace cuboct::gpu
