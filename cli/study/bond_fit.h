// SPDX-License-Identifier: MIT
// `cuboct fit` of a study of Tersoff's parameters (study/potential_fit).
#pragma once

#include <string>

#include "cli/answer.h"

namespace cuboct {

// The exit code. `out` empty: the study's name with .fit; `jobs` 0: one per core.
int fit_bonds(const std::string& path, const std::string& out, int jobs, const Answer& answer);

}  // namespace cuboct
