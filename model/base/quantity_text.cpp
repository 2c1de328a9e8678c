// SPDX-License-Identifier: MIT
#include "model/base/quantity_text.h"

#include <fmt/format.h>

#include <cmath>

namespace cuboct {

Multiple multiple_of(double largest, const std::string& unit) {
  static const char* const kPrefixes[] = {"f", "p", "n", "u", "m", "", "k", "M", "G", "T"};
  constexpr int kOne = 5, kCount = 10;
  // A kilogram has its prefix.
  if (largest == 0 || unit.empty() || unit == "1" || unit.starts_with("kg")) return {1, unit};
  const int place = kOne + static_cast<int>(std::floor(std::log10(std::abs(largest)) / 3 + 1e-9));
  if (place < 0 || place >= kCount) return {1, unit};
  return {std::pow(1000.0, place - kOne), kPrefixes[place] + unit};
}

std::string quantity_text(double value, const std::string& unit) {
  // As it is printed: 999.9 are 1000.
  const double digits = value == 0 ? 0 : std::floor(std::log10(std::abs(value)) + 1e-9);
  const double shown =
      value == 0 ? 0 : std::round(value / std::pow(10, digits - 2)) * std::pow(10, digits - 2);
  const Multiple in = multiple_of(shown, unit);
  if (in.name == unit) return fmt::format("{:.3g}{}{}", value, unit.empty() ? "" : " ", unit);
  return fmt::format("{:.4g} {}", shown / in.unit, in.name);
}

std::string count_text(double count) {
  if (count < 1e6) return fmt::format("{:.0f}", count);
  if (count < 1e9) return fmt::format("{:.3g} million", count / 1e6);
  return fmt::format("{:.4g} billion", count / 1e9);
}

std::string counted(uint64_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string times_text(double times) {
  return times < 1000 ? fmt::format("{:.3g}", times) : count_text(times);
}

std::string waiting_text(double seconds) {
  if (seconds < 0.1) return "under 0.1 s";
  if (seconds < 120) return fmt::format("about {:.2g} s", seconds);
  if (seconds < 7200) return fmt::format("about {:.0f} min", seconds / 60);
  return "about " + count_text(seconds / 3600) + " h";
}

}  // namespace cuboct
