// SPDX-License-Identifier: MIT
// Engines with heavy needs are programs of their own, in the directory of `cuboct`.
#pragma once

#include <string>

namespace cuboct {

// Directory of the running program.
std::string program_directory();

}  // namespace cuboct
