// SPDX-License-Identifier: MIT
// What --help prints: at most 80 columns; of each command what it does, its words, its options and an
// example.
#pragma once

#include <string>

#include "hw/program/options.h"

namespace cuboct {

std::string help_text(const CommandText& command);

}  // namespace cuboct
