// SPDX-License-Identifier: MIT
#include "study/law_fit/csv.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "model/base/error.h"
#include "model/base/excerpt.h"
#include "model/base/text.h"
#include "model/config/config.h"

namespace cuboct::fit {
namespace {

struct Field {
  std::string_view text;
  int column;  // from 1
};

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \"");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \"") + 1 - begin);
}

std::vector<Field> fields_of(std::string_view line, char separator) {
  std::vector<Field> fields;
  for (size_t begin = 0;;) {
    const size_t end = std::min(line.find(separator, begin), line.size());
    const std::string_view text = trimmed(line.substr(begin, end - begin));
    const size_t at = text.empty() ? begin : static_cast<size_t>(text.data() - line.data());
    fields.push_back({text, characters(line.substr(0, at)) + 1});
    if (end == line.size()) return fields;
    begin = end + 1;
  }
}

CsvColumn column_of(const Field& field) {
  CsvColumn column;
  column.column = field.column;
  const std::string_view text = field.text;
  const size_t at = text.find_first_of("([/");
  column.name = trimmed(text.substr(0, at));
  if (at == std::string_view::npos) return column;
  std::string_view unit = text.substr(at + 1);
  if (text[at] != '/') unit = unit.substr(0, unit.find_last_of(")]"));
  column.unit = trimmed(unit);
  return column;
}

double number_of(const Csv& csv, const Field& field, int line) {
  double value = 0;
  const std::string_view digits = field.text.starts_with('+') ? field.text.substr(1) : field.text;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
    csv.fail(line, field.column, fmt::format("'{}' is no finite number", line_text(std::string(field.text))));
  return value;
}

}  // namespace

void Csv::fail(int line, int column, const std::string& message, const std::string& hint) const {
  throw InputError(path, line, column, message, hint, excerpt(line_of(text, line), line, column));
}

Csv read_csv(const std::string& path) {
  Csv csv;
  csv.path = path;
  csv.text = read_config_text(path);
  char separator = 0;
  int number = 0;
  for (const std::string_view line : lines_of(csv.text)) {
    ++number;
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    if (separator == 0) {
      const size_t at = line.find_first_of(",;\t");
      separator = at == std::string_view::npos ? ',' : line[at];
      csv.header = number;
      for (const Field& field : fields_of(line, separator)) csv.columns.push_back(column_of(field));
      continue;
    }
    const std::vector<Field> fields = fields_of(line, separator);
    if (fields.size() != csv.columns.size())
      csv.fail(number, 1, fmt::format("{} fields, but the header has {}", fields.size(), csv.columns.size()));
    for (size_t k = 0; k < fields.size(); ++k)
      csv.columns[k].values.push_back(number_of(csv, fields[k], number));
    csv.lines.push_back(number);
  }
  return csv;
}

}  // namespace cuboct::fit
