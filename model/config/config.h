// SPDX-License-Identifier: MIT
// A TOML file with a memory: every value knows where it stands, every table which keys were asked for. A key
// that no one asked for is an error, so that a misspelt option cannot pass silently. All errors are
// InputError:
//   scenes/a.toml:12:3: unknown key 'capcity'
//     12 |   capcity = 8
//        |   ^
//     hint: did you mean 'capacity'?
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "model/base/places.h"
#include "model/base/units.h"
#include "model/base/vec.h"

namespace cuboct {

// Limits of a number; a limit that is `open` is itself out of range.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;

  static Range any() { return {}; }
  static Range positive() { return {.low = 0, .low_open = true}; }
  static Range not_negative() { return {.low = 0}; }
  static Range between(double low, double high) { return {.low = low, .high = high}; }
  bool contains(double x) const {
    return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
  }
};

struct ConfigFile;  // the parsed file; handles below share it
struct ConfigNode;
class ConfigTable;

// One value of the file.
class ConfigValue {
 public:
  ConfigValue(std::shared_ptr<const ConfigFile> file, const ConfigNode* node)
      : file_(std::move(file)), node_(node) {}

  bool is_table() const;
  bool is_array() const;
  bool is_number() const;
  bool is_string() const;
  bool reduced() const;            // the file's quantities are plain numbers
  const std::string& key() const;  // the last key on the way here; of an array's element: the array's

  bool boolean() const;
  int64_t integer(int64_t low, int64_t high) const;
  std::string string() const;
  // The path of a file that a string names: as it is where absolute, else from the directory of this file.
  std::string file() const;
  // A string that is one of `names`; the index. `what` completes "unknown ...": "shape".
  size_t choice(const std::string& what, const std::vector<std::string>& names) const;

  // A plain number where the dimension is 1 or the file says `units = "reduced"`, else text such as "0.5 mm".
  double number(const Quantity& quantity, const Range& range = Range::any()) const;
  // A unit alone, such as "mm", in SI units; a plain number where the file says `units = "reduced"`.
  double unit(const Quantity& quantity) const;
  // Several: "[0, 1, 2.5] mm", or an array whose elements are single ones.
  std::vector<double> numbers(const Quantity& quantity, const Range& range = Range::any()) const;
  Vec3 vector(const Quantity& quantity) const;
  // "x", "-y", "+z" of the scene, or three plain numbers that are not all 0: of any length.
  Vec3 direction() const;

  std::vector<ConfigValue> items() const;  // of an array
  ConfigTable table() const;

  // Adds the place of this value to others, under `path`.
  void mark(Places& places, const std::string& path) const;
  // Throws InputError that points to a byte of a string's text.
  [[noreturn]] void fail_in(size_t byte, const std::string& message, const std::string& hint = {}) const;
  // Throws InputError that points here.
  [[noreturn]] void fail(const std::string& message, const std::string& hint = {}) const;

 protected:
  double plain(const Quantity& quantity, const Range& range) const;
  void check(double value, const Range& range) const;
  [[noreturn]] void wants(const std::string& what) const;
  [[noreturn]] void lacks_unit(const Quantity& quantity) const;

  std::shared_ptr<const ConfigFile> file_;
  const ConfigNode* node_;
};

class ConfigTable : public ConfigValue {
 public:
  using ConfigValue::ConfigValue;

  // Each of these counts as asking for the key.
  bool has(const std::string& key) const;
  std::optional<ConfigValue> find(const std::string& key) const;
  ConfigValue at(const std::string& key) const;  // a missing key is an error

  double number(const std::string& key, const Quantity& quantity, const Range& range = Range::any()) const;
  double number_or(const std::string& key, const Quantity& quantity, double otherwise,
                   const Range& range = Range::any()) const;
  int64_t integer_or(const std::string& key, int64_t low, int64_t high, int64_t otherwise) const;
  bool boolean_or(const std::string& key, bool otherwise) const;
  std::string string_or(const std::string& key, const std::string& otherwise) const;
  Vec3 vector_or(const std::string& key, const Quantity& quantity, const Vec3& otherwise) const;
  // Subset of "xyz", each at most once, not empty.
  std::array<bool, 3> axes(const std::string& key) const;
  // [[key]] tables; none where the key is absent.
  std::vector<ConfigTable> tables(const std::string& key) const;
  // [key] table; none where the key is absent.
  std::optional<ConfigTable> table_at(const std::string& key) const;

  // The keys of the file, in its order, for tables whose keys are names that the user chose. Counts as asking
  // for all.
  std::vector<std::string> names() const;
  // At most one of the two may be there.
  void not_both(const std::string& a, const std::string& b) const;
  // The name under which record_config_keys notes this table, where tables of one kind stand in many places.
  void record_as(const std::string& name) const;
  // Of all keys within this table.
  Places places() const;
  // Error at the first key that no one asked for, in this table and the tables within that were opened.
  void done() const;
};

// Parses a file. The top-level key `units` ("SI", or "reduced": all quantities are plain numbers) is read
// here.
ConfigTable read_config(const std::string& path);
// Its text alone.
std::string read_config_text(const std::string& path);
// The same for text in memory; `path` stands in messages.
ConfigTable parse_config(std::string text, const std::string& path);

// Every key that anyone has asked for since `keys` was given, as "table.key"; null stops. For the test that
// compares readers with their documentation.
void record_config_keys(std::set<std::string>* keys);

}  // namespace cuboct
