// SPDX-License-Identifier: MIT
// JSON text that may stand inside a script element of HTML.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace cuboct {

std::string json(const std::string& text);  // json_text of model/base/text.h
std::string json(double value);             // the shortest text that reads back the same; null: not finite
std::string json(bool value);
template <typename T>
std::string json_array(const T& items) {  // of items that are JSON already
  std::string out = "[";
  for (const std::string& item : items) out += (out.size() > 1 ? "," : "") + item;
  return out + "]";
}
std::string json(const std::vector<double>& values);
std::string json(const std::vector<size_t>& values);
std::string json(const std::vector<std::string>& texts);

// The array of what `text_of` makes of each item, as JSON.
template <typename T, typename TextOf>
std::string json_array(const T& items, TextOf text_of) {
  std::vector<std::string> texts;
  for (const auto& item : items) texts.push_back(text_of(item));
  return json_array(texts);
}

// {"a":1,"b":[2]}, of values that are JSON already.
std::string json_object(std::initializer_list<std::pair<const char*, std::string>> members);

}  // namespace cuboct
