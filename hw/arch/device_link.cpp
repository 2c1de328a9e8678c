// SPDX-License-Identifier: MIT
#include "hw/arch/device_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hw/arch/given_text.h"
#include "model/base/error.h"
#include "model/base/spelling.h"
#include "model/config/config.h"

namespace cuboct {
namespace {

struct LinkFigureRow {
  const char *name, *unit;
  double low, high;
};
// In the order of LinkFigure.
constexpr std::array<LinkFigureRow, kLinkFigures> kLinkFigureRows{{{"lanes", "1", 1, 1e6},
                                                                   {"pins", "1", 1, 16},
                                                                   {"rate", "Mbit/s", 1e-3, 1e7},
                                                                   {"efficiency", "1", 1e-3, 1},
                                                                   {"delay", "ns", 0, 1e9},
                                                                   {"registers", "cycles", 0, 1000}}};

DeviceLinkKind::Figure figure_of(const ConfigTable& table, const LinkFigureRow& row) {
  DeviceLinkKind::Figure figure;
  figure.value = table.number("value", quantity::number, Range::between(row.low, row.high));
  const std::string unit = given_text(table, "unit", fmt::format("unit = \"{}\"", row.unit));
  if (unit != row.unit)
    table.at("unit").fail(fmt::format("'{}' is in {}, not in '{}'", row.name, row.unit, unit),
                          "convert the value");
  figure.source = given_text(table, "source", "where the value is published, or \"assumed: \" and why");
  table.done();
  return figure;
}

DeviceLinkKind kind_of(const std::string& name, const ConfigTable& table) {
  DeviceLinkKind kind;
  kind.name = name;
  std::vector<std::string> known;
  for (const LinkFigureRow& row : kLinkFigureRows) known.emplace_back(row.name);
  for (const std::string& key : table.names())
    if (std::ranges::find(known, key) == known.end()) {
      const std::string near = did_you_mean(key, known);
      table.at(key).fail(fmt::format("unknown figure '{}'", key),
                         near.empty() ? "one of " + list_of(known) : near);
    }
  for (size_t k = 0; k < kLinkFigureRows.size(); ++k)
    kind.figures[k] = figure_of(table.at(kLinkFigureRows[k].name).table(), kLinkFigureRows[k]);
  return kind;
}

}  // namespace

const char* name_of(LinkFigure figure) { return kLinkFigureRows[static_cast<size_t>(figure)].name; }
const char* unit_of(LinkFigure figure) { return kLinkFigureRows[static_cast<size_t>(figure)].unit; }

double DeviceLinkKind::bits_per_cycle(double clock) const {
  return of(LinkFigure::rate) * 1e6 * of(LinkFigure::efficiency) / clock;
}

int DeviceLinkKind::latency(double clock, int interval) const {
  const double cycles =
      std::ceil(of(LinkFigure::delay) * 1e-9 * clock) + std::ceil(of(LinkFigure::registers)) + interval - 1;
  return static_cast<int>(std::clamp(cycles, 1.0, 1e9));
}

std::vector<DeviceLinkKind> parse_board_links(const std::string& text, const std::string& path) {
  const ConfigTable root = parse_config(text, path);
  std::vector<DeviceLinkKind> kinds;
  for (const std::string& name : root.names()) kinds.push_back(kind_of(name, root.at(name).table()));
  if (kinds.empty()) root.fail("no kind of link", "[NAME.rate] with value, unit and source, and so on");
  return kinds;
}

}  // namespace cuboct
