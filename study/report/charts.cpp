// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "model/base/text.h"
#include "study/report/chart.h"
#include "study/report/chart_axes.h"
#include "study/search/front.h"
#include "study/sweep/numbers.h"
#include "study/sweep/parameters.h"
#include "study/sweep/series.h"

namespace cuboct::study {
namespace {

constexpr char kBlack[] = "#000000", kGrey[] = "#777777";

template <typename Has>
Rows those(const Rows& rows, Has has) {
  Rows some;
  std::ranges::copy_if(rows, std::back_inserter(some), has);
  return some;
}

Rows all_rows(size_t count) {
  Rows rows(count);
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

bool is_error(double value) { return std::isfinite(value) && value >= 0; }

std::optional<ChartBand> below_truth(const Measure& error, const ChartAxis& axis) {
  if (error.floor <= axis.low) return std::nullopt;
  return ChartBand{std::min(error.floor, axis.high), "below: the truth's own error"};
}

Plotted marks_of(const Series& series, double size) {
  return {series.name, series.colour, series.symbol, size, Stroke::none, 0, {}, {}};
}

// Between two points of the front the more exact one has to serve: a stair.
Plotted stair_through(const Rows& front, const ChartAxis& x, const ChartAxis& y) {
  Plotted stair{"Pareto front", "#222222", -1, 0, Stroke::solid, 1.5, {}, {}};
  for (const size_t n : front) {
    if (!stair.places.empty()) stair.places.emplace_back(x.values[n], stair.places.back().second);
    stair.places.emplace_back(x.values[n], y.place(y.values[n]));
  }
  return stair;
}

Chart error_against_speed(const Results& results, const Measure& error, const Measure& speed) {
  const auto& outcomes = results.outcomes;
  const std::vector<double> xs = values_of(results, speed), ys = values_of(results, error);
  const Rows drawn = those(all_rows(outcomes.size()),
                           [&](size_t n) { return std::isfinite(xs[n]) && xs[n] > 0 && is_error(ys[n]); });
  Chart chart;
  chart.id = fmt::format("{}_{}", file_word(error.id), speed.id);
  chart.section = "error-speed";
  chart.title = error.label + " against " + speed.label;
  chart.caption = fmt::format(
      "The better, the lower and the further to the {}. The line is the Pareto front: no other point is both "
      "as "
      "{} and as exact as one on it.",
      speed.less_is_better ? "left" : "right", speed.less_is_better ? "cheap" : "fast");
  chart.corner_left = speed.less_is_better;
  chart.corner = chart.corner_left ? "↙ better" : "better ↘";
  chart.x = decades_axis(speed.label, xs, drawn);
  chart.y = decades_axis(error.label, ys, drawn);
  chart.band = below_truth(error, chart.y);
  chart.best = pareto_front(outcomes, error.value, [&](const Outcome& o) { return speed.merit(o); });
  chart.plotted.push_back(stair_through(chart.best, chart.x, chart.y));
  const auto is = [&](Status status) {
    return [&, status](size_t n) {
      return outcomes[n].status == status && std::ranges::binary_search(drawn, n);
    };
  };
  if (std::ranges::any_of(drawn,
                          is(Status::unstable)))  // for the key; the marks have the colours of their series
    chart.plotted.push_back({"unstable", kGrey, kCross, 9, Stroke::none, 0, {}, {}});
  for (const Status status : {Status::unstable, Status::done})
    for (const Series& series : series_of(results)) {
      const Rows rows = those(series.points, is(status));
      if (rows.empty()) continue;
      Plotted marks = marks_of(series, 9);
      marks.rows = {rows};
      if (status == Status::unstable) marks.name = "unstable", marks.symbol = kCross;
      chart.plotted.push_back(std::move(marks));
    }
  return chart;
}

// The straight line of an order, cut where it leaves the chart below.
std::vector<Place> on_chart(const Line& line, const ChartAxis& x, const ChartAxis& y) {
  const Place &a = line.first, &b = line.second;
  const auto at = [&](double t) {
    return Place{x.logarithmic ? a.first * std::pow(b.first / a.first, t) : std::lerp(a.first, b.first, t),
                 a.second * std::pow(b.second / a.second, t)};
  };
  const double end = b.second >= y.low ? 1 : std::log(y.low / a.second) / std::log(b.second / a.second);
  return {at(0), at(0.6 * end), at(end)};
}

Chart error_against_setting(const Results& results, const Parameter& parameter, const Measure& error) {
  const std::vector<double> ys = values_of(results, error);
  const auto has = [&](size_t n) {
    return std::isfinite(parameter.x[n]) && is_error(ys[n]) && results.outcomes[n].status == Status::done;
  };
  const Rows drawn = those(all_rows(ys.size()), has);
  Chart chart;
  if (drawn.empty()) return chart;
  std::string name = parameter.id;
  std::ranges::replace(name, '.', '-');
  chart.id = fmt::format("{}_by_{}", file_word(error.id), file_word(name));
  chart.section = "settings";
  chart.title = error.label + " against " + parameter.label;
  chart.caption =
      "Lines join points that differ in nothing else. Dashed and dotted: the orders that theory expects "
      "where this "
      "setting alone makes the error, through the least error at its coarsest value.";
  chart.key = false;
  chart.x = parameter.names.empty() ? close_axis(parameter.label, parameter.x, drawn, parameter.logarithmic)
                                    : named_axis(parameter.label, parameter.x, parameter.names);
  chart.y = decades_axis(error.label, ys, drawn);
  chart.band = below_truth(error, chart.y);
  for (const Series& series : series_of(results)) {
    Plotted marks = marks_of(series, 7);
    marks.stroke = Stroke::solid, marks.width = 1;
    std::set<size_t> joined;
    for (const Sweep& sweep : parameter.sweeps) {
      const Rows rows = those(sweep.points, has);
      if (rows.size() < 2 || !std::ranges::binary_search(series.points, rows[0])) continue;
      joined.insert(rows.begin(), rows.end());
      marks.rows.push_back(rows);
    }
    for (const size_t n : those(series.points, has))
      if (!joined.contains(n)) marks.rows.push_back({n});
    if (!marks.rows.empty()) chart.plotted.push_back(std::move(marks));
  }
  bool dotted = false;
  for (const Order& order : expected_orders(results, parameter, error))
    if (const auto line = order_line(results, parameter, error, order)) {
      const Stroke stroke = dotted ? Stroke::dotted : Stroke::dashed;
      chart.plotted.push_back(
          {order.label, kBlack, -1, 0, stroke, 1.5, {}, on_chart(*line, chart.x, chart.y)});
      dotted = !dotted;
    }
  return chart;
}

Chart change_by_rung(const Results& results) {
  const auto& rungs = results.truth.rungs;
  Chart chart;
  std::set<double> steps;
  for (const Rung& rung : rungs) steps.insert(rung.dt);
  if (rungs.size() < 2) return chart;
  const bool by_step = steps.size() == rungs.size();
  std::vector<double> xs, ys;
  const auto add_line = [&](const std::string& name, auto change_of) {
    Rows rows;
    for (size_t r = 0; r < rungs.size(); ++r) {
      const double change = change_of(rungs[r]);
      if (!(change > 0) || !std::isfinite(change)) continue;
      rows.push_back(xs.size());
      xs.push_back(by_step ? rungs[r].dt : static_cast<double>(r)), ys.push_back(change);
      chart.tips.push_back(fmt::format("{}\nrung {}: {}", name, r + 1, number_text(change)));
    }
    const size_t k = chart.plotted.size();
    chart.plotted.push_back(
        {name, series_colour(k), static_cast<int>(k % kSymbols), 8, Stroke::solid, 2, {rows}, {}});
  };
  add_line("trajectory: distance from the rung before, pitches", [](const Rung& r) { return r.trajectory; });
  for (size_t k = 0; k < results.figure_names.size(); ++k)
    add_line(results.figure_names[k] + ": relative distance from the last rung", [&](const Rung& r) {
      const auto& last = rungs.back().figures;
      return k < r.figures.size() && k < last.size() ? std::abs(r.figures[k] / last[k] - 1) : kNotMeasured;
    });
  if (xs.empty()) return chart;
  std::vector<std::string> names;
  for (size_t r = 1; r <= rungs.size(); ++r) names.push_back(std::to_string(r));
  const Rows drawn = all_rows(xs.size()), first = chart.plotted[0].rows[0];
  chart.x = by_step ? decades_axis("time step, s", xs, drawn) : named_axis("rung", xs, names);
  chart.y = decades_axis("change", ys, drawn);
  if (by_step && first.size() > 1)
    for (const auto& [name, order, stroke] :
         {std::tuple{"dt", 1, Stroke::dotted}, std::tuple{"dt²", 2, Stroke::dashed}}) {
      const double from = xs[first.front()], to = xs[first.back()], change = ys[first.front()];
      const std::vector<Place> line{{from, change}, {to, change * std::pow(to / from, order)}};
      chart.plotted.push_back({name, kBlack, -1, 0, stroke, 1.5, {}, line});
    }
  chart.id = chart.section = "truth";
  chart.title = "How much the truth changed with each rung of its refinement";
  chart.caption =
      fmt::format("The truth is refined from the {}.", by_step ? "right to the left" : "left to the right");
  return chart;
}

}  // namespace

std::vector<Chart> charts_of(const Results& results) {
  const std::vector<Measure> errors = error_measures(results), speeds = speed_measures(results);
  std::vector<Chart> charts;
  const auto add = [&](Chart chart, std::optional<size_t> error, std::optional<size_t> speed) {
    chart.error = error, chart.speed = speed;
    if (std::ranges::any_of(chart.plotted, [](const Plotted& p) { return !p.rows.empty(); }) &&
        !chart.id.empty())
      charts.push_back(std::move(chart));
  };
  for (size_t e = 0; e < errors.size(); ++e)
    for (size_t s = 0; s < speeds.size(); ++s) add(error_against_speed(results, errors[e], speeds[s]), e, s);
  for (const Parameter& parameter : swept_parameters(results))
    for (size_t e = 0; e < errors.size(); ++e)
      add(error_against_setting(results, parameter, errors[e]), e, std::nullopt);
  add(change_by_rung(results), std::nullopt, std::nullopt);
  return charts;
}

}  // namespace cuboct::study
