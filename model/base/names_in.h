// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace cuboct {

// Names of what is in a directory, in no order; none where it cannot be read. The iterator of the standard
// library ends the program where memory is short.
std::vector<std::string> names_in(const std::string& directory);

}  // namespace cuboct
