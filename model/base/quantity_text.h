// SPDX-License-Identifier: MIT
// Quantities for people: three digits, in the multiple of the unit that makes them 1 to 1000.
#pragma once

#include <cstdint>
#include <string>

namespace cuboct {

// The unit in which numbers up to `largest` are 1 to 1000: 1e-3 of "m" is "mm".
struct Multiple {
  double unit;  // of the given unit in one of this
  std::string name;
};
Multiple multiple_of(double largest, const std::string& unit);

// "3.2 mm" of 0.0032 and "m"; "2.5e-20 J" beyond the prefixes. A mass is in g.
std::string quantity_text(double value, const std::string& unit);

// "45 million".
std::string count_text(double count);

// "1 node", "2 nodes".
std::string counted(uint64_t count, const char* what);

// Three digits, and from a thousand on as count_text: never an exponent.
std::string times_text(double times);

// Of an estimate: "under 0.1 s", "about 35 s", "about 12 min", "about 3 h".
std::string waiting_text(double seconds);

}  // namespace cuboct
