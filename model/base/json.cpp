// SPDX-License-Identifier: MIT
#include "model/base/json.h"

#include <fmt/format.h>

#include <cmath>

#include "model/base/text.h"

namespace cuboct {

std::string json(const std::string& text) { return json_text(text); }

std::string json(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

std::string json(bool value) { return value ? "true" : "false"; }

std::string json(const std::vector<double>& values) {
  std::vector<std::string> items;
  for (const double value : values) items.push_back(json(value));
  return json_array(items);
}

std::string json(const std::vector<size_t>& values) {
  std::vector<std::string> items;
  for (const size_t value : values) items.push_back(std::to_string(value));
  return json_array(items);
}

std::string json(const std::vector<std::string>& texts) {
  std::vector<std::string> items;
  for (const std::string& text : texts) items.push_back(json(text));
  return json_array(items);
}

std::string json_object(std::initializer_list<std::pair<const char*, std::string>> members) {
  std::string text;
  for (const auto& [name, value] : members)
    text += (text.empty() ? "" : ",\n") + json_text(name) + ":" + value;
  return "{" + text + "}";
}

}  // namespace cuboct
