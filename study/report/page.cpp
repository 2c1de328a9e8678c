// SPDX-License-Identifier: MIT
#include "study/report/page.h"

#include <fmt/format.h>

#include "model/base/filled_frame.h"
#include "model/base/json.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "study/report/chart.h"
#include "study/report/chart_json.h"
#include "study/report/web.h"
#include "study/sweep/measures.h"
#include "study/sweep/series.h"

namespace cuboct::study {
namespace {

std::string measures_json(const Results& results, const std::vector<Measure>& measures) {
  return json_array(measures, [&](const Measure& measure) {
    return json_object({{"id", json(measure.id)},
                        {"label", json(measure.label)},
                        {"less", json(measure.less_is_better)},
                        {"values", json(values_of(results, measure))}});
  });
}

// [error][speed]: the table by decades, as [exponent or null, point].
std::string decades_json(const Results& results, const std::vector<Measure>& errors,
                         const std::vector<Measure>& speeds) {
  const auto row_json = [](const Cheapest& row) {
    return fmt::format("[{},{}]", row.exponent == Cheapest::kExact ? "null" : std::to_string(row.exponent),
                       row.point);
  };
  return json_array(errors, [&](const Measure& error) {
    return json_array(speeds, [&](const Measure& speed) {
      const auto merit = [&](const Outcome& outcome) { return speed.merit(outcome); };
      return json_array(cheapest_by_decade(results.outcomes, error.value, merit), row_json);
    });
  });
}

std::string series_json(const Series& series) {
  return json_object({{"name", json(series.name)},
                      {"colour", json(series.colour)},
                      {"symbol", std::to_string(series.symbol)},
                      {"points", json(series.points)}});
}

std::string changes_json(const std::vector<Change>& changes) {
  return json_array(changes, [](const Change& c) { return json(std::vector{c.key, c.value}); });
}

std::string point_json(const Outcome& outcome) {
  const Settings& settings = outcome.settings;
  return json_object({{"engine", json(settings.engine)},
                      {"arithmetic", json(std::string(label(settings.arithmetic)))},
                      {"integrator", json(std::string(label(settings.integrator)))},
                      {"threads", on_gpu(settings) ? "null" : std::to_string(settings.threads)},
                      {"machine", json(outcome.measured_on())},
                      {"scene", changes_json(settings.scene)},
                      {"arch", changes_json(settings.arch)},
                      {"status", json(std::string(label(outcome.status)))},
                      {"why", json(outcome.why)},
                      {"dt", json(outcome.dt)},
                      {"particles", std::to_string(outcome.particles)},
                      {"steps", std::to_string(outcome.steps)},
                      {"halo_bits", std::to_string(outcome.halo_bits)},
                      {"table_bits", std::to_string(outcome.table_bits)},
                      {"spread", json(outcome.speed.spread)},
                      {"repeats", std::to_string(outcome.speed.repeats)},
                      {"figures", json(outcome.errors.values)}});
}

std::string rung_json(const Rung& rung) {
  return json_object({{"dt", json(rung.dt)},
                      {"cutoff", json(rung.cutoff)},
                      {"figures", json(rung.figures)},
                      {"trajectory", json(rung.trajectory)},
                      {"change", json(rung.change)}});
}

std::string data_of(const Results& results) {
  const std::vector<Measure> errors = error_measures(results), speeds = speed_measures(results);
  const Truth& truth = results.truth;
  std::vector<std::string> columns;
  const std::string charts = charts_json(charts_of(results), columns);
  return json_object({{"title", json(results.title)},
                      {"scene", json(results.scene)},
                      {"machine", json(results.machine)},
                      {"figure_names", json(results.figure_names)},
                      {"figure_units", json(results.figure_units)},
                      {"series", json_array(series_of(results), series_json)},
                      {"errors", measures_json(results, errors)},
                      {"speeds", measures_json(results, speeds)},
                      {"decades", decades_json(results, errors, speeds)},
                      {"charts", charts},
                      {"columns", json_array(columns)},
                      {"points", json_array(results.outcomes, point_json)},
                      {"truth", json_object({{"rungs", json_array(truth.rungs, rung_json)},
                                             {"lyapunov_time", json(truth.lyapunov_time)},
                                             {"floor", json(truth.floor)},
                                             {"largest_frequency", json(truth.largest_frequency)},
                                             {"converged", json(truth.converged)},
                                             {"notes", json(truth.notes)}})}});
}

}  // namespace

bool has_page() { return true; }

std::string page_of(const Results& results) {
  const std::string title = html_text(results.title.empty() ? "A study" : results.title);
  const std::vector<std::pair<const char*, std::string>> parts = {
      {"@title@", title},
      {"@style@", std::string(web_style())},
      {"@title@", title},
      {"@licences@", html_text(std::string(web_licences()))},
      {"@data@", data_of(results)},
      {"@library@", std::string(web_library())},
      {"@script@", std::string(web_script())}};
  return filled_frame(web_frame(), parts);
}

void write_page(const Results& results, const std::string& path) { write_text(path, page_of(results)); }

}  // namespace cuboct::study
