// SPDX-License-Identifier: MIT
// What the files of all studies begin with: a scene, perhaps an arch, and their changes.
#pragma once

#include <string>

#include "model/config/config.h"
#include "study/sweep/settings.h"

namespace cuboct::study {

// The `scene` and `arch` that a study of this path names, with its [change] made. Throws InputError with
// file:line:column.
Base read_changed_base(const ConfigTable& root, const std::string& path);

}  // namespace cuboct::study
