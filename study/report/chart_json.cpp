// SPDX-License-Identifier: MIT
#include "study/report/chart_json.h"

#include <algorithm>
#include <array>

#include "model/base/json.h"

namespace cuboct::study {
namespace {

std::string axis_json(const ChartAxis& axis, std::vector<std::string>& columns) {
  const std::string values = json(axis.values);
  const auto at = std::ranges::find(columns, values) - columns.begin();
  if (at == std::ssize(columns)) columns.push_back(values);
  const auto tick_json = [](const Tick& tick) {
    return json_array(std::array{json(tick.at), json(tick.label)});
  };
  return json_object({{"label", json(axis.label)},
                      {"column", std::to_string(at)},
                      {"logarithmic", json(axis.logarithmic)},
                      {"decades", json(axis.decades)},
                      {"range", json(std::vector{axis.low, axis.high})},
                      {"ticks", json_array(axis.ticks, tick_json)}});
}

std::string plotted_json(const Plotted& plotted) {
  static constexpr const char* kStrokes[] = {"none", "solid", "dashed", "dotted"};
  const auto place_json = [](const Place& place) { return json(std::vector{place.first, place.second}); };
  return json_object({{"name", json(plotted.name)},
                      {"colour", json(plotted.colour)},
                      {"symbol", std::to_string(plotted.symbol)},
                      {"size", json(plotted.size)},
                      {"stroke", json(std::string(kStrokes[static_cast<size_t>(plotted.stroke)]))},
                      {"width", json(plotted.width)},
                      {"rows", json_array(plotted.rows, [](const Rows& rows) { return json(rows); })},
                      {"places", json_array(plotted.places, place_json)}});
}

std::string chart_json(const Chart& chart, std::vector<std::string>& columns) {
  const auto index = [](std::optional<size_t> n) { return n ? std::to_string(*n) : "null"; };
  return json_object(
      {{"section", json(chart.section)},
       {"error", index(chart.error)},
       {"speed", index(chart.speed)},
       {"title", json(chart.title)},
       {"caption", json(chart.caption)},
       {"x", axis_json(chart.x, columns)},
       {"y", axis_json(chart.y, columns)},
       {"plotted", json_array(chart.plotted, plotted_json)},
       {"best", json(chart.best)},
       {"band", chart.band ? json_array(std::array{json(chart.band->high), json(chart.band->text)}) : "null"},
       {"corner", json(chart.corner)},
       {"corner_left", json(chart.corner_left)},
       {"key", json(chart.key)},
       {"tips", json(chart.tips)}});
}

}  // namespace

std::string charts_json(const std::vector<Chart>& charts, std::vector<std::string>& columns) {
  return json_array(charts, [&](const Chart& chart) { return chart_json(chart, columns); });
}

}  // namespace cuboct::study
