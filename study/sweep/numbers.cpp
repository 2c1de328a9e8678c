// SPDX-License-Identifier: MIT
#include "study/sweep/numbers.h"

#include <fmt/format.h>

#include <cmath>

namespace cuboct::study {

std::string superscript(int n) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char c : std::to_string(n)) text += c == '-' ? "⁻" : kDigits[c - '0'];
  return text;
}

std::string power_of_ten(int n) { return n == 0 ? "1" : n == 1 ? "10" : "10" + superscript(n); }

std::string number_text(double x) {
  const std::string text = fmt::format("{:.3e}", x);
  const size_t e = text.find('e');
  const double size = std::abs(x);
  if (x == 0 || (size >= 1e-3 && size < 1e6)) return fmt::format("{}", std::stod(text));
  return fmt::format("{}·10{}", std::stod(text.substr(0, e)), superscript(std::stoi(text.substr(e + 1))));
}

}  // namespace cuboct::study
