// SPDX-License-Identifier: MIT
// The shim's files, embedded at build time, in the order of names.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace cuboct::emu {

const std::vector<std::pair<std::string, std::string>>& shim_sources();

}  // namespace cuboct::emu
