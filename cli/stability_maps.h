// SPDX-License-Identifier: MIT
// Maps of where runs are stable, as pictures.
#pragma once

#include <string>

#include "hw/arch.h"
#include "model/scene.h"

namespace cuboct {

// Throws InputError where the scene is too large for maps of hundreds of runs.
void check_maps(const Scene& scene);

}  // namespace cuboct
