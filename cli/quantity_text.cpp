// SPDX-License-Identifier: MIT
#include "cli/quantity_text.h"

#include <fmt/format.h>

#include <cmath>

namespace cuboct {

std::string quantity_text(double value, const std::string& unit) {
  static const char* const kPrefixes[] = {"f", "p", "n", "u", "m", "", "k", "M", "G", "T"};
  constexpr int kOne = 5, kCount = 10;
  // As it is printed: 999.9 are 1000.
  const double digits = value == 0 ? 0 : std::floor(std::log10(std::abs(value)) + 1e-9);
  const double shown =
      value == 0 ? 0 : std::round(value / std::pow(10, digits - 2)) * std::pow(10, digits - 2);
  const int place =
      shown == 0 ? kOne : kOne + static_cast<int>(std::floor(std::log10(std::abs(shown)) / 3 + 1e-9));
  if (unit.empty() || place < 0 || place >= kCount)
    return fmt::format("{:.3g}{}{}", value, unit.empty() ? "" : " ", unit);
  return fmt::format("{:.4g} {}{}", shown / std::pow(1000.0, place - kOne), kPrefixes[place], unit);
}

std::string count_text(double count) {
  if (count < 1e6) return fmt::format("{:.0f}", count);
  if (count < 1e9) return fmt::format("{:.3g} million", count / 1e6);
  return fmt::format("{:.4g} billion", count / 1e9);
}

}  // namespace cuboct
