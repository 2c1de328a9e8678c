// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "model/config/config.h"

namespace cuboct {

// The text of `key`, which has to be there and to hold more than blanks.
std::string given_text(const ConfigTable& table, const std::string& key, const std::string& hint);

}  // namespace cuboct
