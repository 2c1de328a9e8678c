// SPDX-License-Identifier: MIT
// The headers that compiled code of rules includes: name, text. Embedded when cuboct is built.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace cuboct::emu {

const std::vector<std::pair<std::string, std::string>>& code_sources();

}  // namespace cuboct::emu
