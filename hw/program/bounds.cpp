// SPDX-License-Identifier: MIT
#include "hw/program/bounds.h"

#include <fmt/format.h>

#include <algorithm>

#include "hw/program/options.h"
#include "model/base/error.h"
#include "model/base/resources.h"

namespace cuboct {

void add_anyway_to(Command& command, bool& anyway) {
  command.flag("--anyway", anyway,
               "run although it asks for more memory, disk, threads or time than this machine has");
}

int most_workers() {
  constexpr int kPerCore = 4, kAlways = 16;
  return std::max(kAlways, kPerCore * usable_cores());
}

std::string cores_text() {
  return fmt::format("this machine has {} core{} to use", usable_cores(), usable_cores() == 1 ? "" : "s");
}

void check_workers(const std::string& option, int count, bool anyway) {
  if (anyway || count <= most_workers()) return;
  throw InputError(fmt::format("{} {}: {}", option, count, cores_text()),
                   fmt::format("{} {}{}", option, usable_cores(), kAnyway));
}

std::string long_time(double seconds) {
  constexpr double kDay = 86400, kYear = 365.25 * kDay;
  return seconds < kYear ? fmt::format("{:.3g} days", seconds / kDay)
                         : fmt::format("{:.3g} years", seconds / kYear);
}

void check_time(const std::string& what, double seconds, const std::string& less, bool anyway) {
  if (anyway || !(seconds > kMostSeconds)) return;
  throw InputError(fmt::format("{}: that takes about {}", what, long_time(seconds)), less + kAnyway);
}

void check_memory(const std::string& what, double bytes, const std::string& less, bool anyway) {
  const auto free = static_cast<double>(free_memory());
  if (anyway || !(bytes > free)) return;
  throw InputError(
      fmt::format("{}: that takes about {} of memory: {} are free", what, in_bytes(bytes), in_bytes(free)),
      less + kAnyway);
}

}  // namespace cuboct
