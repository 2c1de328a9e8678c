// SPDX-License-Identifier: MIT
#include "model/config/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string_view>
#include <utility>

#include "model/base/enum_names.h"
#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/input_file.h"
#include "model/base/spelling.h"
#include "model/base/utf8.h"
#include "model/config/foreign_words.h"

namespace cuboct {

struct ConfigNode {
  enum class Kind : uint8_t { boolean, integer, real, string, date, array, table };
  Kind kind = Kind::table;
  int line = 1, column = 1;          // of the value
  int key_line = 1, key_column = 1;  // of its key
  std::string key;
  std::string path;  // "material.region", indices left out
  bool boolean = false;
  int64_t integer = 0;
  double real = 0;
  std::string text;
  std::vector<ConfigNode> items;  // elements of an array, or the fields of a table in the order of the file
  std::map<std::string, size_t> by_key;  // of a table, the indices of its items
  mutable std::string alias;             // instead of the path, for the recorder
  mutable std::set<std::string> asked;
  mutable bool opened = false;  // a table that someone reads
};

struct ConfigFile {
  std::string path, text;
  bool reduced = false;
  ConfigNode root;
};

namespace {

using Kind = ConfigNode::Kind;

std::set<std::string>* recorder = nullptr;

const char* kind_name(Kind kind) {
  constexpr const char* kNames[] = {"true or false", "a whole number", "a number", "a string",
                                    "a date",        "an array",       "a table"};
  return name_in(kNames, kind);
}

ConfigNode convert(const toml::node& from, const std::string& key, const std::string& path) {
  ConfigNode node;
  node.key = key;
  node.path = path;
  node.line = node.key_line = static_cast<int>(from.source().begin.line);
  node.column = node.key_column = static_cast<int>(from.source().begin.column);
  if (const auto* table = from.as_table()) {
    node.kind = Kind::table;
    for (const auto& [name, value] : *table) {
      const std::string text(name.str());
      node.items.push_back(convert(value, text, path.empty() ? text : fmt::format("{}.{}", path, text)));
      node.items.back().key_line = static_cast<int>(name.source().begin.line);
      node.items.back().key_column = static_cast<int>(name.source().begin.column);
    }
    std::ranges::sort(node.items, {},
                      [](const ConfigNode& n) { return std::pair(n.key_line, n.key_column); });
    for (size_t k = 0; k < node.items.size(); ++k) node.by_key.emplace(node.items[k].key, k);
  } else if (const auto* array = from.as_array()) {
    node.kind = Kind::array;
    for (const auto& value : *array) node.items.push_back(convert(value, key, path));
  } else if (const auto* boolean = from.as_boolean()) {
    node.kind = Kind::boolean;
    node.boolean = boolean->get();
  } else if (const auto* integer = from.as_integer()) {
    node.kind = Kind::integer;
    node.integer = integer->get();
  } else if (const auto* real = from.as_floating_point()) {
    node.kind = Kind::real;
    node.real = real->get();
  } else if (const auto* text = from.as_string()) {
    node.kind = Kind::string;
    node.text = text->get();
  } else {
    node.kind = Kind::date;
  }
  return node;
}

double number_in(const ConfigNode& node) {
  return node.kind == Kind::integer ? static_cast<double>(node.integer) : node.real;
}

const ConfigNode* field(const ConfigNode& table, const std::string& key) {
  const auto found = table.by_key.find(key);
  return found == table.by_key.end() ? nullptr : &table.items[found->second];
}

[[noreturn]] void fail_at(const ConfigFile& file, int line, int column, const std::string& message,
                          const std::string& hint = {}) {
  throw InputError(file.path, line, column, message, hint, excerpt(line_of(file.text, line), line, column));
}

// What tells a table from others of an array: its name, or the two that it is between. Empty: nothing.
std::vector<std::string> labels_of(const ConfigNode& table) {
  if (const ConfigNode* name = field(table, "name"); name && name->kind == Kind::string) return {name->text};
  const ConfigNode* between = field(table, "between");
  if (!between || between->items.size() != 2) return {};
  const std::string &a = between->items[0].text, &b = between->items[1].text;
  return {a + "," + b, b + "," + a};
}

// Of arrays the first element stands for all, and those with labels for themselves: of a million particles
// none is looked for by its place.
void add_places(const std::vector<std::string_view>& lines, const ConfigNode& node, const std::string& path,
                Places& places) {
  if (!path.empty()) {
    const std::string_view line = lines[static_cast<size_t>(node.line) - 1];
    places.add(path, node.line, node.column, excerpt(line, node.line, node.column));
  }
  if (node.kind != Kind::array) {
    for (const ConfigNode& item : node.items)
      add_places(lines, item, path.empty() ? item.key : path + "." + item.key, places);
    return;
  }
  if (!node.items.empty()) add_places(lines, node.items[0], path, places);
  for (const ConfigNode& item : node.items)
    for (const std::string& label : labels_of(item))
      add_places(lines, item, fmt::format("{}[{}]", path, label), places);
}

// toml++ and all that reads its tables go as deep as a key is long: a.b.c makes three tables.
void check_keys(const ConfigFile& file) {
  constexpr int kMostParts = 64;
  const std::string_view text = file.text;
  int line = 1, parts = 1;
  size_t line_begin = 0;
  std::string_view quote;  // what ends the string at hand
  for (size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '\n') ++line, line_begin = k + 1, parts = 1;
    if (!quote.empty()) {
      if (c == '\\' && quote[0] == '"')
        ++k;
      else if (text.substr(k).starts_with(quote))
        k += quote.size() - 1, quote = {};
    } else if (c == '"' || c == '\'') {
      quote = text.substr(k, 1);
      if (text.substr(k, 3) == std::string(3, c)) quote = text.substr(k, 3), k += 2;
    } else if (c == '#') {
      k = std::min(text.find('\n', k), text.size()) - 1;
    } else if (c == '.' && ++parts > kMostParts) {
      fail_at(file, line, characters(text.substr(line_begin, k + 1 - line_begin)),
              fmt::format("a key of more than {} parts", kMostParts));
    } else if (c == '=' || c == ',' || c == '[' || c == '{') {
      parts = 1;
    }
  }
}

// What toml++ says of a file that is no TOML; of what happens most in words that say what to write.
std::pair<std::string, std::string> told_of_toml(const std::string& said) {
  if (said.find("control characters other than TAB") != std::string::npos &&
      said.find("comments") == std::string::npos)
    return {"a line ends, or has a control character, within a text",
            "close the text by the quote that began it"};
  const std::string key = "cannot redefine existing table '";
  if (const size_t at = said.find(key); at != std::string::npos && said.ends_with("array-of-tables"))
    if (const std::string rest = said.substr(at + key.size()); rest.find('\'') != std::string::npos) {
      const std::string name = rest.substr(0, rest.find('\''));
      return {said, fmt::format("write [[{}]] for each of them", name)};
    }
  return {said, {}};
}

// The byte-order mark in UTF-8.
void drop_mark(std::string& text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
}

// What the key is elsewhere, or the nearest of those that the table could have.
std::string hint_for(const ConfigNode& table, const std::string& key, const std::vector<std::string>& free) {
  const std::string foreign =
      foreign_hint(foreign_keys(), key, table.alias.empty() ? table.path : table.alias);
  return foreign.empty() ? did_you_mean(key, free) : foreign;
}

// A key that no one has asked for yet, and that looks like one that the table lacks, or is another tool's
// word. Empty: there is none.
std::string misspelt_in(const ConfigNode& table, bool foreign_too) {
  std::vector<std::string> lacking;
  for (const std::string& key : table.asked)
    if (field(table, key) == nullptr) lacking.push_back(key);
  for (const ConfigNode& item : table.items) {
    if (table.asked.contains(item.key)) continue;
    const std::string foreign = foreign_too ? hint_for(table, item.key, {}) : "";
    const std::string hint = foreign.empty() ? did_you_mean(item.key, lacking) : foreign;
    if (!hint.empty()) return fmt::format("line {} has the key '{}': {}", item.key_line, item.key, hint);
  }
  return {};
}

// What a table lacks may stand under a wrong key, in it or beside it.
std::string with_misspelt(const ConfigFile& file, const ConfigNode& table, const std::string& hint) {
  std::string misspelt = misspelt_in(table, true);
  if (misspelt.empty() && &table != &file.root) misspelt = misspelt_in(file.root, false);
  if (misspelt.empty()) return hint;
  return hint.empty() ? misspelt : hint + "; " + misspelt;
}

void check_asked(const ConfigFile& file, const ConfigNode& node) {
  if (node.kind == Kind::table && node.opened) {
    for (const ConfigNode& item : node.items) {
      if (node.asked.contains(item.key)) continue;
      std::vector<std::string> free;
      for (const std::string& key : node.asked)
        if (field(node, key) == nullptr) free.push_back(key);
      fail_at(file, item.key_line, item.key_column, fmt::format("unknown key '{}'", item.key),
              hint_for(node, item.key, free));
    }
  }
  for (const ConfigNode& item : node.items) check_asked(file, item);
}

}  // namespace

bool ConfigValue::is_table() const { return node_->kind == Kind::table; }
bool ConfigValue::is_array() const { return node_->kind == Kind::array; }
bool ConfigValue::is_number() const { return node_->kind == Kind::integer || node_->kind == Kind::real; }
bool ConfigValue::is_string() const { return node_->kind == Kind::string; }
bool ConfigValue::reduced() const { return file_->reduced; }
const std::string& ConfigValue::key() const { return node_->key; }

void ConfigValue::mark(Places& places, const std::string& path) const {
  places.add(path, node_->line, node_->column,
             excerpt(line_of(file_->text, node_->line), node_->line, node_->column));
}

void ConfigValue::fail(const std::string& message, const std::string& hint) const {
  const std::string told = is_table() ? with_misspelt(*file_, *node_, hint) : hint;
  // What is said of the whole file stands at its first line, which says nothing.
  if (node_ == &file_->root) throw InputError(file_->path, node_->line, node_->column, message, told);
  fail_at(*file_, node_->line, node_->column, message, told);
}

void ConfigValue::fail_in(size_t byte, const std::string& message, const std::string& hint) const {
  const std::string_view line = line_of(file_->text, node_->line);
  // The text begins behind the quotes, and stands in the file as it is where nothing is escaped.
  size_t at = static_cast<size_t>(line.data() - file_->text.data());
  for (int column = 1; column < node_->column && at < file_->text.size(); ++column) {
    ++at;
    while (at < file_->text.size() && (static_cast<unsigned char>(file_->text[at]) & 0xc0) == 0x80) ++at;
  }
  const std::string_view rest = std::string_view(file_->text).substr(at);
  const bool long_quotes = rest.starts_with("\"\"\"") || rest.starts_with("'''");
  at += long_quotes ? 3 : 1;
  if (long_quotes && at < file_->text.size() && file_->text[at] == '\n') ++at;
  if (std::string_view(file_->text).substr(at, node_->text.size()) != node_->text ||
      byte > node_->text.size())
    fail(message, hint);
  const std::string_view before(file_->text.data(), at + byte);
  const int number = static_cast<int>(std::ranges::count(before, '\n')) + 1;
  const size_t begin = before.rfind('\n') + 1;  // npos + 1 is 0
  fail_at(*file_, number, characters(before.substr(begin)) + 1, message, hint);
}

void ConfigValue::wants(const std::string& what) const {
  fail(fmt::format("'{}' must be {}, not {}", node_->key, what, kind_name(node_->kind)));
}

// Shows the same value with a unit that fits, where it is likely to be meant in that unit.
void ConfigValue::lacks_unit(const Quantity& quantity) const {
  constexpr size_t kShown = 3;  // elements of a list
  std::vector<double> values;
  if (is_string())
    values = parse_quantity(node_->text).values;
  else if (is_array())
    for (const ConfigNode& item : node_->items) values.push_back(number_in(item));
  else
    values = {number_in(*node_)};
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  std::string such = quantity.example;
  if (values.size() <= kShown && largest < 1e4 && (largest == 0 || largest >= 1e-3)) {
    const bool list = values.size() > 1;
    such = fmt::format("{}{}{}{}", list ? "[" : "", fmt::join(values, ", "), list ? "]" : "",
                       such.substr(such.find(' ')));
  }
  fail(fmt::format("'{}' needs a unit: {} such as \"{}\"", node_->key, quantity.name, such));
}

bool ConfigValue::boolean() const {
  if (node_->kind != Kind::boolean) wants("true or false");
  return node_->boolean;
}

int64_t ConfigValue::integer(int64_t low, int64_t high) const {
  constexpr double kExact = 1e15;  // beyond it digits of a double are not those that were written
  if (node_->kind == Kind::real && std::abs(node_->real) < kExact && node_->real == std::trunc(node_->real))
    fail(fmt::format("'{}' must be a whole number, not a decimal one", node_->key),
         fmt::format("write {:.0f}: a point or an exponent makes a decimal number in TOML", node_->real));
  if (node_->kind != Kind::integer) wants("a whole number");
  if (node_->integer < low || node_->integer > high) {
    fail(high == std::numeric_limits<int64_t>::max()
             ? fmt::format("'{}' must be at least {}, not {}", node_->key, low, node_->integer)
             : fmt::format("'{}' must be between {} and {}, not {}", node_->key, low, high, node_->integer));
  }
  return node_->integer;
}

std::string ConfigValue::string() const {
  constexpr size_t kLongest = 4096;  // bytes, as of a path in Linux; names and titles are shorter
  if (node_->kind != Kind::string) wants("a string");
  if (node_->text.size() > kLongest)
    fail(fmt::format("'{}' is a text of {} bytes: at most {} are read", node_->key, node_->text.size(),
                     kLongest));
  return node_->text;
}

std::string ConfigValue::file() const {
  namespace fs = std::filesystem;
  const std::string name = string();
  std::string path = (fs::path(file_->path).parent_path() / name).string();
  if (!is_file(path))
    fail(fmt::format("no file '{}'", name), "a path is counted from the directory of " + file_->path);
  return path;
}

size_t ConfigValue::choice(const std::string& what, const std::vector<std::string>& names) const {
  const std::string text = string();
  const auto found = std::ranges::find(names, text);
  if (found != names.end()) return static_cast<size_t>(found - names.begin());
  const bool many = node_->key == "kind" || node_->key == "units";
  std::string hint = many ? foreign_hint(foreign_kinds(), text, what) : "";
  if (hint.empty()) hint = did_you_mean(text, names);
  fail(fmt::format("unknown {} '{}'", what, text), hint.empty() ? "known: " + list_of(names) : hint);
}

void ConfigValue::check(double value, const Range& range) const {
  if (std::isfinite(value) && range.contains(value)) return;
  const std::string shown =
      node_->kind == Kind::string ? fmt::format("\"{}\"", node_->text) : fmt::format("{}", value);
  std::string limits;
  if (!std::isfinite(value))
    limits = "finite";
  else if (std::isinf(range.high))
    limits = fmt::format("{} {}", range.low_open ? "greater than" : "at least", range.low);
  else if (range.low_open || range.high_open)
    limits = fmt::format("{} {} and {} {}", range.low_open ? "above" : "at least", range.low,
                         range.high_open ? "below" : "at most", range.high);
  else
    limits = fmt::format("between {} and {}", range.low, range.high);
  fail(fmt::format("'{}' must be {}, not {}", node_->key, limits, shown));
}

double ConfigValue::plain(const Quantity& quantity, const Range& range) const {
  if (node_->kind != Kind::integer && node_->kind != Kind::real) {
    if (node_->kind == Kind::string && quantity.dimension != Dimension{})
      fail(fmt::format("'{}' must be a plain number, as units = \"reduced\"", node_->key));
    wants("a number");
  }
  const double value = number_in(*node_);
  check(value, range);
  return value;
}

double ConfigValue::number(const Quantity& quantity, const Range& range) const {
  if (file_->reduced || quantity.dimension == Dimension{}) return plain(quantity, range);
  if (is_array()) wants(fmt::format("{} such as \"{}\"", quantity.name, quantity.example));
  const std::vector<double> values = numbers(quantity, range);
  if (values.size() != 1)
    fail(fmt::format("'{}' must be {} such as \"{}\", not a list", node_->key, quantity.name,
                     quantity.example));
  return values[0];
}

double ConfigValue::unit(const Quantity& quantity) const {
  if (file_->reduced) return number(quantity, Range::positive());
  try {
    const ParsedQuantity one = parse_quantity("1 " + string());
    if (!one.list && one.dimension == quantity.dimension) return one.values[0];
  } catch (const UnitError&) {
  }
  fail(fmt::format("'{}' must be the unit of {}, not '{}'", node_->key, quantity.name, string()),
       fmt::format("as in \"{}\", without the number", quantity.example));
}

std::vector<double> ConfigValue::numbers(const Quantity& quantity, const Range& range) const {
  std::vector<double> values;
  const bool plain = file_->reduced || quantity.dimension == Dimension{};
  if (is_array()) {
    const auto is_plain = [](const ConfigNode& item) {
      return item.kind == Kind::integer || item.kind == Kind::real;
    };
    if (!plain && !node_->items.empty() && std::ranges::all_of(node_->items, is_plain)) lacks_unit(quantity);
    for (const ConfigValue& item : items()) values.push_back(item.number(quantity, range));
    return values;
  }
  if (plain) wants("an array of numbers");
  const std::string such = fmt::format("{} such as \"{}\"", quantity.name, quantity.example);
  if (is_number()) lacks_unit(quantity);
  if (!is_string()) wants(such);
  try {
    const ParsedQuantity parsed = parse_quantity(node_->text);
    if (parsed.dimension == Dimension{}) lacks_unit(quantity);
    if (parsed.dimension != quantity.dimension)
      fail(fmt::format("'{}' must be {}, but \"{}\" is {}", node_->key, such, node_->text,
                       describe(parsed.dimension)));
    for (double value : parsed.values) check(value, range);
    return parsed.values;
  } catch (const UnitError& error) {
    fail(error.message, error.hint);
  }
}

Vec3 ConfigValue::vector(const Quantity& quantity) const {
  const std::vector<double> values = numbers(quantity);
  if (values.size() != 3) {
    const bool plain = file_->reduced || quantity.dimension == Dimension{};
    const std::string example = quantity.example;
    fail(fmt::format("'{}' needs three components, not {}", node_->key, values.size()),
         plain ? "for instance [0, 0, 1]"
               : fmt::format("for instance \"[0, 0, 1]{}\"", example.substr(example.find(' '))));
  }
  return {values[0], values[1], values[2]};
}

Vec3 ConfigValue::direction() const {
  Vec3 v = Vec3::Zero();
  if (is_array()) {
    v = vector(quantity::number);
    if (v.isZero(0)) fail(fmt::format("'{}' must not be zero", node_->key));
    return v;
  }
  if (!is_string()) wants("a direction such as \"z\", \"-x\" or [1, 1, 0]");
  const std::string& text = node_->text;
  const bool sign = text.starts_with('-') || text.starts_with('+');
  const char axis = text.empty() ? '\0' : text.back();
  if (text.size() != (sign ? 2 : 1) || axis < 'x' || axis > 'z')
    fail(fmt::format("unknown direction '{}'", text), "such as \"z\", \"-x\" or three numbers: [1, 1, 0]");
  v[axis - 'x'] = text[0] == '-' ? -1 : 1;
  return v;
}

std::vector<ConfigValue> ConfigValue::items() const {
  if (!is_array()) wants("an array");
  std::vector<ConfigValue> values;
  for (const ConfigNode& item : node_->items) values.emplace_back(file_, &item);
  return values;
}

ConfigTable ConfigValue::table() const {
  if (!is_table()) wants("a table");
  node_->opened = true;
  return {file_, node_};
}

bool ConfigTable::has(const std::string& key) const { return find(key).has_value(); }

std::optional<ConfigValue> ConfigTable::find(const std::string& key) const {
  node_->asked.insert(key);
  if (recorder != nullptr) {
    const std::string& table = node_->alias.empty() ? node_->path : node_->alias;
    recorder->insert(table.empty() ? key : table + "." + key);
  }
  const ConfigNode* found = field(*node_, key);
  if (found == nullptr) return std::nullopt;
  return ConfigValue(file_, found);
}

ConfigValue ConfigTable::at(const std::string& key) const {
  if (auto found = find(key)) return *found;
  // Where a key that no one asked for looks like the missing one, it is the better complaint.
  for (const ConfigNode& item : node_->items)
    if (!node_->asked.contains(item.key) && !nearest_spelling(item.key, {key}).empty())
      fail_at(*file_, item.key_line, item.key_column, fmt::format("unknown key '{}'", item.key),
              did_you_mean(item.key, {key}));
  if (node_->path.empty()) fail(fmt::format("missing key '{}'", key));
  fail(fmt::format("missing key '{}' in '{}'", key, node_->path));
}

double ConfigTable::number(const std::string& key, const Quantity& quantity, const Range& range) const {
  return at(key).number(quantity, range);
}

double ConfigTable::number_or(const std::string& key, const Quantity& quantity, double otherwise,
                              const Range& range) const {
  const auto value = find(key);
  return value ? value->number(quantity, range) : otherwise;
}

int64_t ConfigTable::integer_or(const std::string& key, int64_t low, int64_t high, int64_t otherwise) const {
  const auto value = find(key);
  return value ? value->integer(low, high) : otherwise;
}

bool ConfigTable::boolean_or(const std::string& key, bool otherwise) const {
  const auto value = find(key);
  return value ? value->boolean() : otherwise;
}

std::string ConfigTable::string_or(const std::string& key, const std::string& otherwise) const {
  const auto value = find(key);
  return value ? value->string() : otherwise;
}

Vec3 ConfigTable::vector_or(const std::string& key, const Quantity& quantity, const Vec3& otherwise) const {
  const auto value = find(key);
  return value ? value->vector(quantity) : otherwise;
}

std::array<bool, 3> ConfigTable::axes(const std::string& key) const {
  const ConfigValue value = at(key);
  const std::string text = value.string();
  std::array<bool, 3> chosen{};
  for (char c : text) {
    const size_t axis = static_cast<size_t>(c - 'x');
    if (c < 'x' || c > 'z' || chosen[axis])
      value.fail(fmt::format("'{}' must name axes, such as \"x\" or \"xyz\", not \"{}\"", key, text));
    chosen[axis] = true;
  }
  if (text.empty()) value.fail(fmt::format("'{}' must name axes, such as \"x\" or \"xyz\"", key));
  return chosen;
}

std::vector<ConfigTable> ConfigTable::tables(const std::string& key) const {
  std::vector<ConfigTable> result;
  const auto value = find(key);
  if (!value) return result;
  if (!value->is_array())
    value->fail(fmt::format("'{}' must be an array of tables", key), fmt::format("write [[{}]]", key));
  for (const ConfigValue& item : value->items()) result.push_back(item.table());
  return result;
}

std::optional<ConfigTable> ConfigTable::table_at(const std::string& key) const {
  const auto value = find(key);
  if (!value) return std::nullopt;
  if (!value->is_table())
    value->fail(fmt::format("'{}' must be a table", key), fmt::format("write [{}]", key));
  return value->table();
}

std::vector<std::string> ConfigTable::names() const {
  std::vector<std::string> names;
  for (const ConfigNode& item : node_->items) {
    names.push_back(item.key);
    node_->asked.insert(item.key);
  }
  return names;
}

void ConfigTable::not_both(const std::string& a, const std::string& b) const {
  const auto second = find(b);
  if (find(a) && second) second->fail(fmt::format("give '{}' or '{}', not both", a, b));
}

void ConfigTable::record_as(const std::string& name) const { node_->alias = name; }

Places ConfigTable::places() const {
  Places places(file_->path);
  add_places(lines_of(file_->text), *node_, "", places);
  return places;
}

void ConfigTable::done() const { check_asked(*file_, *node_); }

ConfigTable parse_config(std::string text, const std::string& path) {
  auto file = std::make_shared<ConfigFile>();
  file->path = path;
  file->text = std::move(text);
  drop_mark(file->text);
  check_utf8(file->text, path);
  check_keys(*file);
  try {
    file->root = convert(toml::parse(file->text, path), "", "");
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    const auto [message, hint] = told_of_toml(std::string(error.description()));
    fail_at(*file, static_cast<int>(at.line), static_cast<int>(at.column), message, hint);
  }
  file->root.line = file->root.column = 1;
  file->root.opened = true;
  ConfigTable root(file, &file->root);
  if (const auto units = root.find("units")) file->reduced = units->choice("units", {"SI", "reduced"}) == 1;
  return root;
}

std::string read_config_text(const std::string& path) {
  std::string text = read_input(path);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw InputError(fmt::format("{}: this file is in UTF-16", path), "save it as UTF-8");
  drop_mark(text);
  return text;
}

ConfigTable read_config(const std::string& path) { return parse_config(read_config_text(path), path); }

void record_config_keys(std::set<std::string>* keys) { recorder = keys; }

}  // namespace cuboct
