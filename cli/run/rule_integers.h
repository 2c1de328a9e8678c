// SPDX-License-Identifier: MIT
// What `cuboct check` tells of a rule that is text, in integers.
#pragma once

#include "cli/items.h"
#include "hw/arch/arch.h"
#include "model/scene/scene.h"

namespace cuboct {

// Formats of its fields; of each round its work, the errors of its tables, and what its sums keep. Or why
// integers do not hold it. Nothing of other rules.
void add_integers(Items& items, const Scene& scene, const Arch& arch);

}  // namespace cuboct
