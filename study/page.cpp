// SPDX-License-Identifier: MIT
#include "study/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "study/chart.h"
#include "study/measures.h"
#include "study/series.h"
#include "study/web.h"

namespace cuboct::study {
namespace {

std::string measures_json(const Results& results, const std::vector<Measure>& measures) {
  std::vector<std::string> items;
  for (const Measure& measure : measures)
    items.push_back(JsonObject()
                        .add("id", json(measure.id))
                        .add("label", json(measure.label))
                        .add("less", json(measure.less_is_better))
                        .add("floor", json(measure.floor))
                        .add("values", json(values_of(results, measure)))
                        .text());
  return json_array(items);
}

// [error][speed]: the table by decades, as [exponent or null, point].
std::string decades_json(const Results& results, const std::vector<Measure>& errors,
                         const std::vector<Measure>& speeds) {
  std::vector<std::string> by_error;
  for (const Measure& error : errors) {
    std::vector<std::string> by_speed;
    for (const Measure& speed : speeds) {
      std::vector<std::string> rows;
      for (const Cheapest& row : cheapest_by_decade(results.outcomes, error.value,
                                                    [&](const Outcome& o) { return speed.merit(o); }))
        rows.push_back(fmt::format(
            "[{},{}]", row.exponent == Cheapest::kExact ? "null" : std::to_string(row.exponent), row.point));
      by_speed.push_back(json_array(rows));
    }
    by_error.push_back(json_array(by_speed));
  }
  return json_array(by_error);
}

// Charts name their values by an index into `columns`: several share one.
std::string axis_json(const ChartAxis& axis, std::vector<std::string>& columns) {
  const std::string values = json(axis.values);
  const auto at = std::ranges::find(columns, values) - columns.begin();
  if (at == std::ssize(columns)) columns.push_back(values);
  std::vector<std::string> ticks;
  for (const Tick& tick : axis.ticks)
    ticks.push_back(json_array(std::array{json(tick.at), json(tick.label)}));
  return JsonObject()
      .add("label", json(axis.label))
      .add("column", std::to_string(at))
      .add("logarithmic", json(axis.logarithmic))
      .add("decades", json(axis.decades))
      .add("range", json(std::vector{axis.low, axis.high}))
      .add("ticks", json_array(ticks))
      .text();
}

std::string plotted_json(const Plotted& plotted) {
  static constexpr const char* kStrokes[] = {"none", "solid", "dashed", "dotted"};
  std::vector<std::string> rows, places;
  for (const Rows& joined : plotted.rows) rows.push_back(json(joined));
  for (const auto& [x, y] : plotted.places) places.push_back(json(std::vector{x, y}));
  return JsonObject()
      .add("name", json(plotted.name))
      .add("colour", json(plotted.colour))
      .add("symbol", std::to_string(plotted.symbol))
      .add("size", json(plotted.size))
      .add("stroke", json(std::string(kStrokes[static_cast<size_t>(plotted.stroke)])))
      .add("width", json(plotted.width))
      .add("rows", json_array(rows))
      .add("places", json_array(places))
      .text();
}

std::string chart_json(const Chart& chart, std::vector<std::string>& columns) {
  const auto index = [](std::optional<size_t> n) { return n ? std::to_string(*n) : "null"; };
  std::vector<std::string> plotted;
  for (const Plotted& one : chart.plotted) plotted.push_back(plotted_json(one));
  return JsonObject()
      .add("section", json(chart.section))
      .add("error", index(chart.error))
      .add("speed", index(chart.speed))
      .add("title", json(chart.title))
      .add("caption", json(chart.caption))
      .add("x", axis_json(chart.x, columns))
      .add("y", axis_json(chart.y, columns))
      .add("plotted", json_array(plotted))
      .add("best", json(chart.best))
      .add("band",
           chart.band ? json_array(std::array{json(chart.band->high), json(chart.band->text)}) : "null")
      .add("corner", json(chart.corner))
      .add("corner_left", json(chart.corner_left))
      .add("key", json(chart.key))
      .add("tips", json(chart.tips))
      .text();
}

std::string series_json(const Results& results) {
  std::vector<std::string> items;
  for (const Series& series : series_of(results))
    items.push_back(JsonObject()
                        .add("name", json(series.name))
                        .add("colour", json(series.colour))
                        .add("symbol", std::to_string(series.symbol))
                        .add("points", json(series.points))
                        .text());
  return json_array(items);
}

std::string changes_json(const std::vector<Change>& changes) {
  std::vector<std::string> items;
  for (const Change& change : changes) items.push_back(json(std::vector{change.key, change.value}));
  return json_array(items);
}

std::string points_json(const Results& results) {
  std::vector<std::string> items;
  for (const Outcome& outcome : results.outcomes) {
    const Settings& settings = outcome.settings;
    items.push_back(JsonObject()
                        .add("engine", json(settings.engine))
                        .add("arithmetic", json(std::string(label(settings.arithmetic))))
                        .add("integrator", json(std::string(label(settings.integrator))))
                        .add("threads", on_gpu(settings) ? "null" : std::to_string(settings.threads))
                        .add("machine", json(outcome.measured_on()))
                        .add("scene", changes_json(settings.scene))
                        .add("arch", changes_json(settings.arch))
                        .add("status", json(std::string(label(outcome.status))))
                        .add("why", json(outcome.why))
                        .add("dt", json(outcome.dt))
                        .add("pitch", json(outcome.pitch))
                        .add("particles", std::to_string(outcome.particles))
                        .add("steps", std::to_string(outcome.steps))
                        .add("halo_bits", std::to_string(outcome.halo_bits))
                        .add("table_bits", std::to_string(outcome.table_bits))
                        .add("spread", json(outcome.speed.spread))
                        .add("repeats", std::to_string(outcome.speed.repeats))
                        .add("figures", json(outcome.errors.values))
                        .text());
  }
  return json_array(items);
}

std::string truth_json(const Results& results) {
  const Truth& truth = results.truth;
  std::vector<std::string> rungs;
  for (const Rung& rung : truth.rungs)
    rungs.push_back(JsonObject()
                        .add("dt", json(rung.dt))
                        .add("cutoff", json(rung.cutoff))
                        .add("figures", json(rung.figures))
                        .add("trajectory", json(rung.trajectory))
                        .add("change", json(rung.change))
                        .text());
  return JsonObject()
      .add("rungs", json_array(rungs))
      .add("figures", json(truth.figures))
      .add("lyapunov_time", json(truth.lyapunov_time))
      .add("floor", json(truth.floor))
      .add("largest_frequency", json(truth.largest_frequency))
      .add("converged", json(truth.converged))
      .add("notes", json(truth.notes))
      .text();
}

std::string data_of(const Results& results) {
  const std::vector<Measure> errors = error_measures(results), speeds = speed_measures(results);
  std::vector<std::string> charts, columns;
  for (const Chart& chart : charts_of(results)) charts.push_back(chart_json(chart, columns));
  return JsonObject()
      .add("title", json(results.title))
      .add("scene", json(results.scene))
      .add("machine", json(results.machine))
      .add("figure_names", json(results.figure_names))
      .add("figure_units", json(results.figure_units))
      .add("series", series_json(results))
      .add("errors", measures_json(results, errors))
      .add("speeds", measures_json(results, speeds))
      .add("decades", decades_json(results, errors, speeds))
      .add("charts", json_array(charts))
      .add("columns", json_array(columns))
      .add("points", points_json(results))
      .add("truth", truth_json(results))
      .text();
}

}  // namespace

bool has_page() { return true; }

// The frame's places "@name@", in their order.
std::string page_of(const Results& results) {
  const std::string title = html_text(results.title.empty() ? "A study" : results.title);
  const std::pair<const char*, std::string> parts[] = {{"@title@", title},
                                                       {"@style@", std::string(web_style())},
                                                       {"@title@", title},
                                                       {"@licences@", html_text(std::string(web_licences()))},
                                                       {"@data@", data_of(results)},
                                                       {"@library@", std::string(web_library())},
                                                       {"@script@", std::string(web_script())}};
  const std::string_view frame = web_frame();
  std::string page;
  size_t from = 0;
  for (const auto& [name, text] : parts) {
    const size_t at = frame.find(name, from);
    if (at == std::string_view::npos) throw std::logic_error(fmt::format("study/web/page.html: no {}", name));
    page += frame.substr(from, at - from);
    page += text;
    from = at + std::string_view(name).size();
  }
  page += frame.substr(from);
  return page;
}

void write_page(const Results& results, const std::string& path) { write_text(path, page_of(results)); }

}  // namespace cuboct::study
