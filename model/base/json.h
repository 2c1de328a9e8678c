// SPDX-License-Identifier: MIT
// JSON text that may stand inside a script element of HTML.
#pragma once

#include <string>
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

// {"a":1,"b":[2]}
class JsonObject {
 public:
  JsonObject& add(const std::string& name, const std::string& value_as_json);
  std::string text() const { return "{" + members_ + "}"; }

 private:
  std::string members_;
};

}  // namespace cuboct
