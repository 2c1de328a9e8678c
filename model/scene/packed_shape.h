// SPDX-License-Identifier: MIT
// The shape that a scene packs, and with which crystal: read once more from the scene's text, as a scene
// keeps its particles alone.
#pragma once

#include <optional>

#include "model/body/packing_scatter.h"
#include "model/scene/scene.h"

namespace cuboct {

// None where no single crystal is packed. InputError as of the scene, which has been read before.
std::optional<PackedShape> packed_shape(const Scene& scene);

}  // namespace cuboct
