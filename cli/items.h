// SPDX-License-Identifier: MIT
// What a command found, as named values: lines for people, JSON for scripts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cuboct {

class Items {
 public:
  void add(const std::string& name, const std::string& text, const std::string& note = {});
  void add(const std::string& name, const char* text) { add(name, std::string(text)); }
  void add(const std::string& name, uint64_t value, const std::string& unit = {},
           const std::string& note = {});
  void add(const std::string& name, int64_t value, const std::string& unit = {},
           const std::string& note = {});
  void add(const std::string& name, int value, const std::string& unit = {}, const std::string& note = {}) {
    add(name, int64_t{value}, unit, note);
  }
  void add(const std::string& name, uint32_t value, const std::string& unit = {},
           const std::string& note = {}) {
    add(name, uint64_t{value}, unit, note);
  }
  void add(const std::string& name, double value, const std::string& unit = {}, const std::string& note = {});

  // A number that changed: its last value, and between which it was. In JSON "smallest" and "largest" beside
  // "value".
  void add_range(const std::string& name, double last, double smallest, double largest,
                 const std::string& unit);

  // Several findings of one kind: in the text a line "line: <text>" each, where <text> is the value of its
  // item "text"; in JSON {"value": [{"step": 1, ...}, ...]}, values alone.
  void add_list(const std::string& name, const std::string& line, const std::vector<Items>& list);

  // A further member of the last one's JSON object, whose value is JSON already.
  void also(const std::string& member, const std::string& json);

  // "name   value unit (note)" per line, values in one column.
  std::string text() const;
  // {"name": {"value": 1, "unit": "m", "note": "..."}, ...} with a final newline; blanks of names become '_'.
  // Numbers that JSON cannot hold (nan, inf) are null.
  std::string json() const;

  struct Item {
    std::string name, text, json, unit, note;  // `json`: the value as JSON
    bool list = false;                         // `text` is whole lines
    std::string more = {};                     // further members of the JSON object, each after a comma
  };
  const std::vector<Item>& all() const { return items_; }

 private:
  std::vector<Item> items_;
};

}  // namespace cuboct
