// SPDX-License-Identifier: MIT
#include "study/json.h"

#include <fmt/format.h>

#include <cmath>

namespace cuboct::study {

std::string json(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (c == '<' || static_cast<unsigned char>(c) < 0x20)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + '"';
}

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

JsonObject& JsonObject::add(const std::string& name, const std::string& value_as_json) {
  if (!members_.empty()) members_ += ",\n";
  members_ += json(name) + ":" + value_as_json;
  return *this;
}

}  // namespace cuboct::study
