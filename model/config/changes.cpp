// SPDX-License-Identifier: MIT
#include "model/config/changes.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <charconv>
#include <filesystem>
#include <string_view>

#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/text.h"
#include "model/base/utf8.h"

namespace cuboct {
namespace {

toml::table parsed(const std::string& text, const std::string& path) {
  check_utf8(text, path);
  try {
    return toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    throw InputError(path, static_cast<int>(at.line), static_cast<int>(at.column),
                     std::string(error.description()), {},
                     excerpt(line_of(text, static_cast<int>(at.line)), static_cast<int>(at.line),
                             static_cast<int>(at.column)));
  }
}

// Byte of a position of toml++, which counts lines and code points from 1.
size_t byte_at(const std::string& text, const toml::source_position& at) {
  size_t byte = 0;
  for (toml::source_index line = 1; line < at.line; ++line) byte = text.find('\n', byte) + 1;
  for (toml::source_index column = 1; column < at.column && byte < text.size(); ++column) do
      ++byte;
    while (byte < text.size() && (static_cast<unsigned char>(text[byte]) & 0xC0) == 0x80);
  return byte;
}

size_t line_end(const std::string& text, size_t byte) {
  const size_t end = text.find('\n', byte);
  return end == std::string::npos ? text.size() : end + 1;
}

std::vector<std::string> parts_of(const std::string& key) {
  std::vector<std::string> parts(1);
  for (const char c : key) {
    if (c == '.')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

// A part of a key as TOML has it: bare where it may be.
std::string key_text(const std::string& part) {
  const bool bare =
      part.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
      std::string::npos;
  return bare && !part.empty() ? part : toml_string(part);
}

std::string joined(const std::string& above, const std::string& part) {
  return above.empty() ? key_text(part) : fmt::format("{}.{}", above, key_text(part));
}

void check_value(const std::string& path, const Change& change) {
  try {
    if (toml::parse("value = " + change.value).size() == 1) return;
  } catch (const toml::parse_error&) {
  }
  throw InputError(
      fmt::format("{}: '{}' cannot become {}: that is no TOML value", path, change.key, change.value));
}

// The node that `part` names in `node`; null where there is none.
toml::node* child(toml::node& node, const std::string& part, const std::string& path, const Change& change) {
  if (auto* table = node.as_table()) return table->get(part);
  if (auto* array = node.as_array()) {
    size_t index = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
    if (error != std::errc() || end != part.data() + part.size() || index >= array->size())
      throw InputError(fmt::format("{}: '{}': there are {} of these, counted from 0, and no '{}'", path,
                                   change.key, array->size(), part));
    return array->get(index);
  }
  throw InputError(fmt::format("{}: '{}' runs through a value that is no table", path, change.key));
}

// Where a key goes that its table lacks: before the first line that is neither comment nor blank at the top,
// behind a table's header, or before an inline table's brace.
std::string with_added(std::string text, const toml::table& table, bool is_root, const std::string& line) {
  if (is_root) {
    size_t at = 0;
    while (at < text.size()) {
      const size_t first = text.find_first_not_of(" \t\r", at);
      if (first == std::string::npos || (text[first] != '#' && text[first] != '\n')) break;
      at = line_end(text, first);
    }
    return text.insert(at, line + "\n");
  }
  if (table.is_inline()) {
    const size_t brace = text.rfind('}', byte_at(text, table.source().end) - 1);
    return text.insert(brace, (table.empty() ? " " : ", ") + line + " ");
  }
  const size_t header = line_end(text, byte_at(text, table.source().begin));
  const bool open = header > 0 && text[header - 1] != '\n';  // the file ends with the header
  return text.insert(header, (open ? "\n" : "") + line + "\n");
}

// What stands before the key, or before the names of its tables where it is dotted, is the end of a line, or
// of an inline table the brace or the comma.
std::string without(std::string text, const toml::table& table, const std::string& key) {
  const auto found = table.find(key);
  const size_t at = byte_at(text, found->first.source().begin);
  const size_t end = byte_at(text, found->second.source().end);
  const size_t before = at == 0 ? std::string::npos : text.find_last_of("\n{,", at - 1);
  if (before == std::string::npos || text[before] == '\n') {
    const size_t begin = before == std::string::npos ? 0 : before + 1;
    return text.erase(begin, line_end(text, end) - begin);
  }
  if (text[before] == ',') return text.erase(before, end - before);
  const size_t next = text.find_first_not_of(" \t", end);
  return text.erase(before + 1, (text[next] == ',' ? next + 1 : end) - before - 1);
}

std::string with_change(std::string text, const std::string& path, const Change& change) {
  toml::table root = parsed(text, path);
  if (!change.value.empty()) check_value(path, change);
  const std::vector<std::string> parts = parts_of(change.key);
  toml::node* node = &root;
  std::string above;  // the table's name so far
  for (size_t k = 0; k + 1 < parts.size(); ++k) {
    toml::node* next = child(*node, parts[k], path, change);
    if (next == nullptr) {
      if (change.value.empty()) return text;
      std::string name = above;
      for (size_t rest = k; rest + 1 < parts.size(); ++rest) name = joined(name, parts[rest]);
      if (!text.empty() && text.back() != '\n') text += '\n';
      return text + fmt::format("\n[{}]\n{} = {}\n", name, key_text(parts.back()), change.value);
    }
    above = joined(above, parts[k]);
    node = next;
  }
  toml::node* value = child(*node, parts.back(), path, change);
  if (value == nullptr) {
    if (change.value.empty()) return text;
    return with_added(std::move(text), *node->as_table(), node == &root,
                      key_text(parts.back()) + " = " + change.value);
  }
  if (change.value.empty()) {
    if (!node->is_table())
      throw InputError(
          fmt::format("{}: '{}' is an element of an array and cannot be taken out", path, change.key));
    return without(std::move(text), *node->as_table(), parts.back());
  }
  const size_t begin = byte_at(text, value->source().begin), end = byte_at(text, value->source().end);
  return text.replace(begin, end - begin, change.value);
}

}  // namespace

std::string with_changes(const std::string& text, const std::string& path,
                         const std::vector<Change>& changes) {
  std::string result = text;
  for (const Change& change : changes) result = with_change(std::move(result), path, change);
  parsed(result, path);
  return result;
}

namespace {

void find_files(const toml::node& node, const std::string& key, const std::filesystem::path& directory,
                std::vector<Change>& changes) {
  const auto below = [&](std::string_view part) {
    return key.empty() ? std::string(part) : fmt::format("{}.{}", key, part);
  };
  if (const toml::table* table = node.as_table()) {
    for (const auto& [name, value] : *table) {
      if (name.str().find('.') != std::string_view::npos) continue;  // no key of a change
      const auto file = value.value<std::string>();
      if (name.str() == "file" && file && !std::filesystem::path(*file).is_absolute())
        changes.push_back({below("file"), json_text((directory / *file).lexically_normal().string())});
      find_files(value, below(name.str()), directory, changes);
    }
  } else if (const toml::array* array = node.as_array()) {
    for (size_t k = 0; k < array->size(); ++k)
      find_files((*array)[k], below(std::to_string(k)), directory, changes);
  }
}

}  // namespace

std::string with_whole_paths(const std::string& text, const std::string& path) {
  std::vector<Change> changes;
  find_files(parsed(text, path), "", std::filesystem::absolute(path).parent_path(), changes);
  return with_changes(text, path, changes);
}

}  // namespace cuboct
