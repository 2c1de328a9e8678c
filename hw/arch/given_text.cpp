// SPDX-License-Identifier: MIT
#include "hw/arch/given_text.h"

#include <fmt/format.h>

namespace cuboct {

std::string given_text(const ConfigTable& table, const std::string& key, const std::string& hint) {
  const auto value = table.find(key);
  if (!value) table.fail(fmt::format("'{}' has no {}", table.key(), key), hint);
  const std::string text = value->string();
  if (text.find_first_not_of(" \t\n") == std::string::npos)
    value->fail(fmt::format("the {} of '{}' is empty", key, table.key()), hint);
  return text;
}

}  // namespace cuboct
