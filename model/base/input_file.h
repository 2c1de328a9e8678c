// SPDX-License-Identifier: MIT
// Files that a user names, who may name anything.
#pragma once

#include <cstdint>
#include <string>

namespace cuboct {

// Bytes of text that are read at most: a scene of some four million particles, one by one.
inline constexpr uint64_t kMostInput = uint64_t{256} << 20;

// The bytes of a file, or of a pipe until its writer closes it; of a pipe that no one writes into none.
// InputError where it cannot be read, is a directory or a device, or holds more than `most`.
std::string read_input(const std::string& path, uint64_t most = kMostInput);

// For readers that open it by themselves: InputError where it is there and no file. A pipe would let them
// wait.
void check_is_file(const std::string& path);

// Whether there is such a file; no, too, where no file can have the name.
bool is_file(const std::string& path);

}  // namespace cuboct
