// SPDX-License-Identifier: MIT
#include "model/config/name.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/base/text.h"

namespace cuboct {

std::string read_name(const ConfigValue& value) {
  std::string name = value.string();
  if (name.empty())
    value.fail(fmt::format("'{}' must not be empty", value.key()), "a name such as \"part_1\"");
  if (name == "." || name == "..")
    value.fail(fmt::format("'{}' must not be '{}', which means a directory", value.key(), name),
               "a name such as \"part_1\"");
  if (name.find('/') != std::string::npos) {
    std::string other = name;
    std::ranges::replace(other, '/', '_');
    value.fail(fmt::format("'{}' must not hold '/': '{}'", value.key(), name),
               fmt::format("such as '{}'", other));
  }
  if (line_text(name) != name)
    value.fail(fmt::format("'{}' must hold visible characters alone: '{}'", value.key(), name),
               "no line ends, tabs or other control characters");
  return name;
}

}  // namespace cuboct
