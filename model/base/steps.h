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

// The steps 0, every, 2 every, ... and `last`; every 0: 0 and `last` alone.
std::vector<uint64_t> every_so_often(uint64_t every, uint64_t last);

}  // namespace cuboct
