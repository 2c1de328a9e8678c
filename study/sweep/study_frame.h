// SPDX-License-Identifier: MIT
// What all studies have in common.
#pragma once

#include <string>

#include "model/config/config.h"
#include "study/sweep/study.h"

namespace cuboct::study {

// A study without points, search and speed, whose keys are not asked for: base, figures, times, truth. Throws
// InputError with file:line:column.
Study read_study_frame(const ConfigTable& root, const std::string& path);

}  // namespace cuboct::study
