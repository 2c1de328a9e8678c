// SPDX-License-Identifier: MIT
// Texts of machine files that must not be blank.
#pragma once
#include <string>

#include "model/config/config.h"

namespace cuboct {

// The text of `key`, which has to be there and to hold more than blanks.
std::string given_text(const ConfigTable& table, const std::string& key, const std::string& hint);

}  // namespace cuboct
