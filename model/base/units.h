// SPDX-License-Identifier: MIT
// Physical dimensions and the text form of quantities: "0.5 mm", "1.41 g/cm^3", "[0, 0, -9.81] m/s^2".
//
// A unit is built of named units with `*`, `/`, `^` and a whole exponent, and parentheses; `*` and `/` bind
// alike, from left to right; `1` stands alone in "1/s". Named units are those of unit_names.h, each
// with the prefixes f p n u (or µ) m c k M G T where that gives no other named unit.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace cuboct {

// Exponents of kg, m, s, rad and K. The radian is kept apart so that an angle cannot pass for a plain number.
struct Dimension {
  std::array<int, 5> exponent{};
  bool operator==(const Dimension&) const = default;
};

// A dimension as users know it: the words for messages and an example of a value.
struct Quantity {
  Dimension dimension;
  const char* name;     // "a length"
  const char* example;  // "0.5 mm"
};

namespace quantity {
inline constexpr Quantity number{{{0, 0, 0, 0}}, "a number", "0.5"};
inline constexpr Quantity length{{{0, 1, 0, 0}}, "a length", "0.5 mm"};
inline constexpr Quantity area{{{0, 2, 0, 0}}, "an area", "10 mm^2"};
inline constexpr Quantity mass{{{1, 0, 0, 0}}, "a mass", "2 mg"};
inline constexpr Quantity time{{{0, 0, 1, 0}}, "a time", "1 us"};
inline constexpr Quantity velocity{{{0, 1, -1, 0}}, "a velocity", "2 m/s"};
inline constexpr Quantity acceleration{{{0, 1, -2, 0}}, "an acceleration", "9.81 m/s^2"};
inline constexpr Quantity density{{{1, -3, 0, 0}}, "a density", "1.41 g/cm^3"};
inline constexpr Quantity force{{{1, 1, -2, 0}}, "a force", "3 N"};
inline constexpr Quantity stiffness{{{1, 0, -2, 0}}, "a stiffness", "1 MN/m"};
inline constexpr Quantity pressure{{{1, -1, -2, 0}}, "a pressure", "3 GPa"};
inline constexpr Quantity energy{{{1, 2, -2, 0}}, "an energy", "1 uJ"};
inline constexpr Quantity surface_energy{{{1, 0, -2, 0}}, "an energy per area", "20 kJ/m^2"};
inline constexpr Quantity damping{{{1, 0, -1, 0}}, "a damping coefficient", "0.1 kg/s"};
inline constexpr Quantity angle{{{0, 0, 0, 1}}, "an angle", "30 deg"};
inline constexpr Quantity angular_velocity{{{0, 0, -1, 1}}, "an angular velocity", "10 rad/s"};
inline constexpr Quantity temperature{{{0, 0, 0, 0, 1}}, "a temperature", "300 K"};
}  // namespace quantity

// "a length" for the known ones, else base units: "kg*m^2/s^3".
std::string describe(const Dimension& dimension);

// The unit whose factor is 1: "J", "Pa", else of base units, "kg/s".
std::string si_unit(const Dimension& dimension);

// What a text says, in SI units. A decimal prefix moves the decimal exponent before the digits are read, so
// that "1.41 g/cm^3" is exactly the double nearest to 1410.
struct ParsedQuantity {
  std::vector<double> values;  // one, or those between brackets
  bool list = false;           // written with brackets
  Dimension dimension;
  bool operator==(const ParsedQuantity&) const = default;
};

// Throws UnitError.
ParsedQuantity parse_quantity(std::string_view text);

// What is wrong with the text, and a hint or nothing. The reader of a file makes an InputError of it.
struct UnitError {
  std::string message;
  std::string hint;
};

}  // namespace cuboct
