// SPDX-License-Identifier: MIT
// The page of a run's directory: one HTML file that loads nothing else.
#pragma once

#include <string>

namespace cuboct {

// Throws InputError where the directory holds no run that is over, or `out` cannot be written.
void write_report(const std::string& directory, const std::string& out);

}  // namespace cuboct
