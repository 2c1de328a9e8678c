// SPDX-License-Identifier: MIT
#include "hw/cost/technology.h"

#include <fmt/format.h>

#include "hw/arch/given_text.h"
#include "model/base/error.h"
#include "model/base/spelling.h"
#include "model/config/file_kind.h"

namespace cuboct {
namespace {

struct ConstantRow {
  const char *name, *unit;
};
// In the order of Constant.
constexpr std::array<ConstantRow, kConstants> kConstantRows{{{"add_bit", "pJ/bit"},
                                                             {"multiply_bit2", "pJ/bit^2"},
                                                             {"register_bit", "pJ/bit"},
                                                             {"clock_bit", "pJ/bit"},
                                                             {"memory_read", "pJ/bit"},
                                                             {"memory_write", "pJ/bit"},
                                                             {"memory_exponent", "1"},
                                                             {"leakage_transistor", "pW"},
                                                             {"leakage_memory_bit", "pW"},
                                                             {"wire_bit_mm", "pJ/bit/mm"},
                                                             {"link_bit", "pJ/bit"},
                                                             {"clock_device", "pJ"},
                                                             {"static_device", "mW"},
                                                             {"transistor_area", "um^2"},
                                                             {"register_area", "um^2"},
                                                             {"memory_bit_area", "um^2"},
                                                             {"wire_pitch", "um"}}};

TechnologyFigure figure_of(const ConfigTable& table, const std::string& unit, bool of_memory) {
  constexpr double kMost = 1e12;  // of any figure in its unit
  TechnologyFigure figure;
  figure.band.low = table.number("low", quantity::number, Range::between(0, kMost));
  figure.band.high = table.number("high", quantity::number, Range::between(0, kMost));
  if (figure.band.low > figure.band.high)
    table.at("low").fail(
        fmt::format("'{}': low {:g} is above high {:g}", table.key(), figure.band.low, figure.band.high),
        "low is the least figure published or measured, high the greatest");
  const std::string told = given_text(table, "unit", fmt::format("unit = \"{}\"", unit));
  if (told != unit)
    table.at("unit").fail(fmt::format("'{}' is in {}, not in '{}'", table.key(), unit, told),
                          "convert low and high");
  if (of_memory) figure.words = table.number("words", quantity::number, Range::between(1, kMost));
  figure.source =
      given_text(table, "source", "where low and high are published, or \"measured by\" which script");
  table.done();
  return figure;
}

void check_key(const ConfigTable& root, const std::string& key, const std::vector<std::string>& known) {
  for (const std::string& name : known)
    if (key == name) return;
  const std::string near = did_you_mean(key, known);
  root.at(key).fail(fmt::format("unknown constant '{}'", key),
                    near.empty() ? "one of " + list_of(known) : near);
}

Technology technology_of(const ConfigTable& root) {
  Technology technology;
  technology.name = root.at("name").string();
  technology.title = root.string_or("title", "");
  std::vector<std::string> known;
  for (const ConstantRow& row : kConstantRows) known.emplace_back(row.name);
  for (const std::string& key : root.names())
    if (key != "name" && key != "title") check_key(root, key, known);
  for (size_t k = 0; k < kConstants; ++k) {
    const auto constant = static_cast<Constant>(k);
    if (const auto table = root.table_at(kConstantRows[k].name))
      technology.figures[k] =
          figure_of(*table, kConstantRows[k].unit,
                    constant == Constant::memory_read || constant == Constant::memory_write);
  }
  const bool memory = technology.at(Constant::memory_read) || technology.at(Constant::memory_write);
  if (memory && !technology.at(Constant::memory_exponent))
    root.fail("memory_read and memory_write need memory_exponent",
              "[memory_exponent]: energy of a bit goes with words to this power");
  return technology;
}

}  // namespace

const char* name_of(Constant constant) { return kConstantRows[static_cast<size_t>(constant)].name; }
const char* unit_of(Constant constant) { return kConstantRows[static_cast<size_t>(constant)].unit; }

Technology parse_technology(const std::string& text, const std::string& path) {
  return read_kind(FileKind::technology, text, path, technology_of);
}

Technology read_technology(const std::string& path) {
  return read_kind(FileKind::technology, path, technology_of);
}

std::vector<LinkKind> parse_links(const std::string& text, const std::string& path) {
  const ConfigTable root = parse_config(text, path);
  std::vector<LinkKind> links;
  for (const std::string& name : root.names())
    links.push_back({name, figure_of(root.at(name).table(), unit_of(Constant::link_bit), false)});
  return links;
}

}  // namespace cuboct
