// SPDX-License-Identifier: MIT
#include "cli/machine/clock_option.h"

#include <fmt/format.h>

#include "model/base/error.h"
#include "model/base/units.h"

namespace cuboct {

double clock_of(const std::string& text) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("--clock: '{}' {}", text, why), "--clock '100 MHz'");
  };
  try {
    const ParsedQuantity q = parse_quantity(text);
    if (q.list || q.dimension != Dimension{{0, 0, -1}}) refuse("is not a frequency");
    constexpr double kLeast = 1, kMost = 1e12;
    if (!(q.values[0] >= kLeast && q.values[0] <= kMost)) refuse("is not in [1 Hz, 1 THz]");
    return q.values[0];
  } catch (const UnitError& error) {
    refuse("is not a frequency: " + error.message);
  }
  return 0;
}

}  // namespace cuboct
