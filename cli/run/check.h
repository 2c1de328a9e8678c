// SPDX-License-Identifier: MIT
// What `cuboct check` tells of a scene.
#pragma once

#include "cli/command.h"
#include "cli/items.h"

namespace cuboct {

// What a scene becomes: sizes, time step, widths, tables, records, latencies, and what its plan leaves out.
Items resolve(const Loaded& loaded);

}  // namespace cuboct
