// SPDX-License-Identifier: MIT
// Texts of emitted files with places to fill.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace cuboct {

// Each NAME between two @, in capitals and underscores, becomes its value; what a value holds stays as it is.
// std::logic_error where a name has no value: no place is left unfilled.
std::string fill(std::string_view text, const std::map<std::string, std::string, std::less<>>& values);

}  // namespace cuboct
