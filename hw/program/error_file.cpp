// SPDX-License-Identifier: MIT
#include "hw/program/error_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <sstream>

#include "model/base/error_parts.h"
#include "model/base/output.h"

namespace cuboct {

void write_error(const std::string& path, const InputError& error) {
  toml::table table{{"message", bare_message(error)}, {"hint", parts_of(error).hint}};
  if (const InputError::Place* place = error.place()) {
    table.insert("file", place->file);
    table.insert("line", place->line);
    table.insert("column", place->column);
    table.insert("excerpt", place->excerpt);
  }
  std::ostringstream text;
  text << table << '\n';
  write_text(path, text.str());
}

InputError read_error(const std::string& path) {
  try {
    const toml::table table = toml::parse_file(path);
    const auto text = [&](const char* key) { return table[key].value_or(std::string()); };
    if (!table.contains("file")) return InputError(text("message"), text("hint"));
    return {
        text("file"),   table["line"].value_or(1), table["column"].value_or(1), text("message"), text("hint"),
        text("excerpt")};
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{} holds no error: {}", path, error.description()));
  }
}

}  // namespace cuboct
