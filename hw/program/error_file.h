// SPDX-License-Identifier: MIT
// How a program's error reaches the command that started it, which tells it: a file of TOML.
#pragma once

#include <string>

#include "model/base/error.h"

namespace cuboct {

void write_error(const std::string& path, const InputError& error);

// What another process wrote there. Throws InputError where that is no such file.
InputError read_error(const std::string& path);

}  // namespace cuboct
