// SPDX-License-Identifier: MIT
// Pictures by gnuplot, from scripts, in which all text is quoted by model/base/text.h.
#pragma once

#include <string>

#include "model/base/process.h"

namespace cuboct {

// Runs a script, written into `scratch`, without the user's own settings of gnuplot. Throws InputError where
// gnuplot is not there, std::runtime_error where it ends with an error (its own text is on stderr).
void run_gnuplot(const Scratch& scratch, const std::string& script);

}  // namespace cuboct
