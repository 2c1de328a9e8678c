// SPDX-License-Identifier: MIT
// Texts of emitted files with places to fill.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace cuboct {

// Each NAME between two @, in capitals and underscores, becomes its value; what a value holds stays as it is.
// std::logic_error where a name has no value: no place is left unfilled.
std::string fill(std::string_view text, const std::map<std::string, std::string, std::less<>>& values);

// A value in two's complement, as a sized hexadecimal literal.
std::string literal(int64_t value, int bits);

}  // namespace cuboct
