// SPDX-License-Identifier: MIT
// Lists of steps that people and programs hand to an engine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cuboct {

// From a file, one step per line; blank lines count for nothing. Ascending, each once. Throws InputError with
// file and line.
std::vector<uint64_t> read_steps(const std::string& path);

// Ascending, each once.
void put_in_order(std::vector<uint64_t>& steps);

}  // namespace cuboct
