// SPDX-License-Identifier: MIT
// The page of a run's directory: one HTML file that loads nothing else.
#pragma once

#include <string>

namespace cuboct {

// Throws InputError where the directory holds no run that is over, or `out` cannot be written.
void write_report(const std::string& directory, const std::string& out);

// A page up to its heading; a browser loads it anew every `refresh` seconds, but for 0.
std::string page_head(const std::string& title, int refresh = 0);
// A PNG file's bytes as a figure.
std::string page_picture(const std::string& png);

}  // namespace cuboct
