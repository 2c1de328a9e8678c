// SPDX-License-Identifier: MIT
// What static loading cannot do.
#pragma once
#include "model/scene/scene.h"

namespace cuboct {

// InputError where a load step moves a constraint so far at once, before the body follows, that bonds would
// be out of reach, and torn.
void refuse_tearing(const Scene& scene, const StaticLoading& loading);

}  // namespace cuboct
