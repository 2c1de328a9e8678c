// SPDX-License-Identifier: MIT
// Maps of where runs are stable, as pictures.
#pragma once

#include <string>

#include "study/stability/stability_map.h"

namespace cuboct::study {

// DIRECTORY/<name>.png and .svg: the cells of the map with the theory's line over them. The names written.
std::vector<std::string> draw(const StabilityMap& map, const std::string& directory);

}  // namespace cuboct::study
