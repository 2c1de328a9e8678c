// SPDX-License-Identifier: MIT
// Quantities for people: three digits, in the multiple of the unit that makes them 1 to 1000.
#pragma once

#include <string>

namespace cuboct {

// "3.2 mm" of 0.0032 and "m"; "2.5e-20 J" beyond the prefixes. A mass is in g.
std::string quantity_text(double value, const std::string& unit);

// "45 million".
std::string count_text(double count);

}  // namespace cuboct
