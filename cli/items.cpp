// SPDX-License-Identifier: MIT
#include "cli/items.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/base/json.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

constexpr const char* kNone = "not there";  // no unit stands behind it

}  // namespace

void Items::add(const std::string& name, const std::string& text, const std::string& note) {
  items_.push_back({name, text, cuboct::json(text), "", note, false});
}

void Items::add(const std::string& name, uint64_t value, const std::string& unit, const std::string& note) {
  items_.push_back({name, std::to_string(value), std::to_string(value), unit, note, false});
}

void Items::add(const std::string& name, int64_t value, const std::string& unit, const std::string& note) {
  items_.push_back({name, std::to_string(value), std::to_string(value), unit, note, false});
}

void Items::add(const std::string& name, double value, const std::string& unit, const std::string& note) {
  items_.push_back({name, std::isnan(value) ? kNone : fmt::format("{:.6g}", value), cuboct::json(value), unit,
                    note, false});
}

void Items::add_range(const std::string& name, double last, double smallest, double largest,
                      const std::string& unit) {
  add(name, last, unit == "1" ? "" : unit, fmt::format("{:.4g} to {:.4g}", smallest, largest));
  items_.back().more =
      fmt::format(", \"smallest\": {}, \"largest\": {}", cuboct::json(smallest), cuboct::json(largest));
}

void Items::also(const std::string& member, const std::string& json) {
  items_.back().more += fmt::format(", {}: {}", cuboct::json(member), json);
}

void Items::add_list(const std::string& name, const std::string& line, const std::vector<Items>& list) {
  Item item{name, "", "[", "", "", true};
  const char* separator = "";
  for (const Items& one : list) {
    item.json += fmt::format("{}\n    {{", separator);
    const char* inner = "";
    for (const Item& part : one.all()) {
      if (part.name == "text") item.text += fmt::format("{}: {}\n", line, line_text(part.text));
      item.json += fmt::format("{}{}: {}", inner, cuboct::json(part.name), part.json);
      inner = ", ";
    }
    item.json += "}";
    separator = ",";
  }
  item.json += list.empty() ? "]" : "\n  ]";
  items_.push_back(std::move(item));
}

std::string Items::text() const {
  size_t width = 0;
  for (const Item& item : items_)
    if (!item.list) width = std::max(width, item.name.size());
  std::string out;
  for (const Item& item : items_) {
    if (item.list) {
      out += item.text;
      continue;
    }
    out += fmt::format("{:<{}}  {}", line_text(item.name), width, line_text(item.text));
    if (!item.unit.empty() && item.text != kNone) out += fmt::format(" {}", line_text(item.unit));
    if (!item.note.empty()) out += fmt::format(" ({})", line_text(item.note));
    out += '\n';
  }
  return out;
}

std::string Items::json() const {
  std::string out = "{";
  const char* separator = "\n";
  for (const Item& item : items_) {
    std::string name = item.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    out += fmt::format("{}  {}: {{\"value\": {}", separator, cuboct::json(name), item.json);
    if (!item.unit.empty()) out += ", \"unit\": " + cuboct::json(item.unit);
    if (!item.note.empty()) out += ", \"note\": " + cuboct::json(item.note);
    out += item.more + "}";
    separator = ",\n";
  }
  return out + "\n}\n";
}

}  // namespace cuboct
