// SPDX-License-Identifier: MIT
// Names that a user chooses: of probes, materials, constraints, machines.
#pragma once

#include <string>

#include "model/config/config.h"

namespace cuboct {

// The string at `value`. A name becomes part of a path in a trace, a word of a frame and a line of a table,
// so it has at least one character, none of them '/' or hidden (model/base/text.h), and is neither "." nor
// "..". InputError points at it.
std::string read_name(const ConfigValue& value);

}  // namespace cuboct
