// SPDX-License-Identifier: MIT
// Pictures by gnuplot, from scripts.
#pragma once

#include <string>

#include "model/process.h"

namespace cuboct::study {

// Runs a script, written into `scratch`. Throws InputError where gnuplot is not there, std::runtime_error
// where it ends with an error (its own text is on stderr).
void run_gnuplot(const Scratch& scratch, const std::string& script);

}  // namespace cuboct::study
