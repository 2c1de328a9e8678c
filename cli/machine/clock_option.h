// SPDX-License-Identifier: MIT
// The option --clock.
#pragma once

#include <string>

namespace cuboct {

// Hz of what --clock says, such as "100 MHz". Throws InputError.
double clock_of(const std::string& text);

}  // namespace cuboct
