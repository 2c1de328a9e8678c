// SPDX-License-Identifier: MIT
#include "cli/stability_maps.h"

namespace cuboct {
void check_maps(const Scene&) {}
}  // namespace cuboct
