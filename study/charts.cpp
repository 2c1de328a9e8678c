// SPDX-License-Identifier: MIT
// The page's charts by gnuplot: one script draws all, each once as PNG and once as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "model/base/gnuplot.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "study/measures.h"
#include "study/page.h"
#include "study/parameters.h"
#include "study/series.h"

namespace cuboct::study {
namespace {

constexpr size_t kLongName = 24;  // letters

// gnuplot's point types that look like the page's symbols.
constexpr int kPointTypes[kSymbols] = {7, 5, 9, 13, 11, 15};

// Whole decades that hold all values; where one of them is 0, a decade below stands for it.
struct LogRange {
  double low = 0.1, high = 1;
  bool zero = false;
  double placed(double value) const { return value == 0 ? low : value; }
};
LogRange log_range(const std::vector<double>& values) {
  double least = INFINITY, most = 0;
  LogRange range;
  for (const double value : values) {
    if (value == 0) range.zero = true;
    if (value > 0) least = std::min(least, value), most = std::max(most, value);
  }
  if (most > 0) {
    const double low = std::floor(std::log10(least) + 1e-9), high = std::ceil(std::log10(most) - 1e-9);
    range.low = std::pow(10, low), range.high = std::pow(10, std::max(high, low + 1));
  }
  if (range.zero) range.low /= 10;
  return range;
}

class Script {
 public:
  explicit Script(std::string directory) : directory_(std::move(directory)) {}

  void begin(const std::string& name) {
    name_ = name;
    settings_ = data_ = "";
    plots_.clear();
    set("border 3 lc '#444444'");
    set("tics nomirror");
    set("grid lc '#dddddd' lt 1 lw 0.5");
    set("key outside right top Left reverse noenhanced samplen 2 spacing 1.15");
  }
  // Names that take half of the width beside the chart stand below it.
  void key_of(const std::vector<Series>& all) {
    const bool is_long = std::ranges::any_of(all, [](const Series& s) { return s.name.size() > kLongName; });
    if (is_long) set("key below Left reverse noenhanced samplen 2 spacing 1.15");
  }
  void set(const std::string& what) { settings_ += "set " + what + "\n"; }

  // `reversed`: less is better, and better is to the right.
  void log_axis(char axis, const std::string& label, const LogRange& range, bool reversed = false) {
    set(fmt::format("{}label {}", axis, gnuplot_label(label)));
    set(fmt::format("logscale {}", axis));
    set(fmt::format("format {} '10^{{%T}}'", axis));
    set(fmt::format("{}range [{}:{}]", axis, reversed ? range.high : range.low,
                    reversed ? range.low : range.high));
    if (range.zero) set(fmt::format("{}tics add ('0' {})", axis, range.low));
  }
  void band(double floor, const LogRange& range) {
    if (floor <= range.low) return;
    set(fmt::format(
        "object 1 rectangle from graph 0,first {} to graph 1,first {} behind fillstyle solid noborder "
        "fillcolor '#e8e8e8'",
        range.low, std::min(floor, range.high)));
    set(
        fmt::format("label 1 \"below: the truth's own error\" at graph 0.99,first {} right offset 0,0.6 "
                    "textcolor '#555555'",
                    range.low));
  }
  // `style`: after "with".
  void plot(const std::vector<std::pair<double, double>>& points, const std::string& title,
            const std::string& style) {
    if (points.empty()) return;
    const std::string block = fmt::format("$data{}", plots_.size());
    data_ += block + " << END\n";
    for (const auto& [x, y] : points) data_ += fmt::format("{} {}\n", x, y);
    data_ += "END\n";
    plots_.push_back(fmt::format("{} using 1:2 with {} {}", block, style,
                                 title.empty() ? "notitle" : fmt::format("title {}", gnuplot_label(title))));
  }
  void end() {
    if (plots_.empty()) return;
    std::string plot = "plot ";
    for (const std::string& one : plots_) plot += (plot.size() > 5 ? ", " : "") + one;
    text_ += "reset\n" + data_ + settings_;
    text_ += output("pngcairo size 1100,680 font 'Helvetica,13' background '#ffffff'", ".png") + plot + "\n";
    text_ +=
        output("svg size 1100,680 dynamic font 'Helvetica,14' background '#ffffff'", ".svg") + plot + "\n";
  }

  const std::string& text() const { return text_; }
  const std::vector<std::string>& files() const { return files_; }

 private:
  std::string output(const std::string& terminal, const std::string& ending) {
    files_.push_back(name_ + ending);
    return fmt::format("set terminal {}\nset output {}\n", terminal,
                       gnuplot_file(directory_ + "/" + files_.back()));
  }

  std::string directory_, name_, settings_, data_, text_;
  std::vector<std::string> plots_, files_;
};

std::string marks(const Series& series, double size) {
  return fmt::format("points pt {} ps {} lc '{}'", kPointTypes[series.symbol], size, series.colour);
}

void draw_error_speed(const Results& results, const Measure& error, const Measure& speed, Script& script) {
  const auto& outcomes = results.outcomes;
  const auto shown = [&](size_t n) {
    return error.value(outcomes[n]) >= 0 && speed.value(outcomes[n]) > 0 &&
           std::isfinite(error.value(outcomes[n])) && std::isfinite(speed.value(outcomes[n]));
  };
  std::vector<double> xs, ys;
  for (size_t n = 0; n < outcomes.size(); ++n)
    if (shown(n)) xs.push_back(speed.value(outcomes[n])), ys.push_back(error.value(outcomes[n]));
  const LogRange x = log_range(xs), y = log_range(ys);
  const auto place = [&](size_t n) {
    return std::pair{speed.value(outcomes[n]), y.placed(error.value(outcomes[n]))};
  };
  script.begin(fmt::format("{}_{}", file_word(error.id), speed.id));
  script.key_of(series_of(results));
  script.log_axis('x', speed.label, x, speed.less_is_better);
  script.log_axis('y', error.label, y);
  script.band(error.floor, y);

  const auto front = pareto_front(outcomes, error.value, [&](const Outcome& o) { return speed.merit(o); });
  std::vector<std::pair<double, double>> stair, rings, unstable;
  for (size_t k = 0; k < front.size(); ++k) {
    const auto at = place(front[k]);
    // Between two points of the front the more exact one has to serve.
    if (k > 0) stair.emplace_back(at.first, stair.back().second);
    stair.push_back(at);
    rings.push_back(at);
  }
  for (const Series& series : series_of(results)) {
    std::vector<std::pair<double, double>> points;
    for (const size_t n : series.points)
      if (shown(n)) (outcomes[n].status == Status::done ? points : unstable).push_back(place(n));
    script.plot(points, series.name, marks(series, 0.9));
  }
  script.plot(unstable, "unstable", "points pt 2 ps 0.7 lc '#777777'");
  script.plot(stair, "Pareto front", "lines lw 1.5 lc '#222222'");
  script.plot(rings, "", "points pt 6 ps 1.7 lw 1.5 lc '#222222'");
  script.end();
}

void draw_parameter(const Results& results, const Parameter& parameter, const Measure& error,
                    Script& script) {
  const auto& outcomes = results.outcomes;
  const auto shown = [&](size_t n) {
    const double e = error.value(outcomes[n]);
    return std::isfinite(parameter.x[n]) && e >= 0 && std::isfinite(e) && outcomes[n].status == Status::done;
  };
  std::vector<double> xs, ys;
  for (size_t n = 0; n < outcomes.size(); ++n)
    if (shown(n)) xs.push_back(parameter.x[n]), ys.push_back(error.value(outcomes[n]));
  if (xs.empty()) return;
  const LogRange y = log_range(ys);
  std::string name = parameter.id;
  std::replace(name.begin(), name.end(), '.', '-');
  script.begin(fmt::format("{}_by_{}", file_word(error.id), file_word(name)));
  script.key_of(series_of(results));
  if (parameter.logarithmic) {
    script.log_axis('x', parameter.label, log_range(xs));
  } else {
    const auto [low, high] = std::minmax_element(xs.begin(), xs.end());
    const double margin = *high > *low ? 0.06 * (*high - *low) : 1;
    script.set(fmt::format("xlabel {}", gnuplot_label(parameter.label)));
    script.set(fmt::format("xrange [{}:{}]", *low - margin, *high + margin));
    std::string tics;
    for (size_t k = 0; k < parameter.names.size(); ++k)
      tics += fmt::format("{}{} {}", k > 0 ? ", " : "", gnuplot_text(parameter.names[k]), k);
    if (!tics.empty()) script.set("xtics noenhanced (" + tics + ")");
  }
  script.log_axis('y', error.label, y);
  script.band(error.floor, y);
  const auto place = [&](size_t n) { return std::pair{parameter.x[n], y.placed(error.value(outcomes[n]))}; };
  for (const Series& series : series_of(results)) {
    std::vector<std::pair<double, double>> points;
    for (const size_t n : series.points)
      if (shown(n)) points.push_back(place(n));
    script.plot(points, series.name, marks(series, 0.8));
    for (const Sweep& sweep : parameter.sweeps) {
      if (std::find(series.points.begin(), series.points.end(), sweep.points.front()) == series.points.end())
        continue;
      std::vector<std::pair<double, double>> line;
      for (const size_t n : sweep.points)
        if (shown(n)) line.push_back(place(n));
      script.plot(line, "", fmt::format("lines lw 0.8 lc '{}'", series.colour));
    }
  }
  int dash = 2;
  for (const Order& order : expected_orders(results, parameter, error))
    if (const auto line = order_line(results, parameter, error, order))
      script.plot({line->first, line->second}, order.label,
                  fmt::format("lines lw 1.8 dt {} lc '#000000'", dash++));
  script.end();
}

void draw_truth(const Results& results, Script& script) {
  const auto& rungs = results.truth.rungs;
  std::vector<std::pair<std::string, std::vector<std::pair<double, double>>>> lines{
      {"trajectory, distance from the rung before, pitches", {}}};
  for (const std::string& name : results.figure_names)
    lines.push_back({name + ", relative distance from the last rung", {}});
  std::vector<double> xs, ys;
  const auto add = [&](size_t line, double dt, double value) {
    if (!(value > 0) || !std::isfinite(value)) return;
    lines[line].second.emplace_back(dt, value);
    xs.push_back(dt), ys.push_back(value);
  };
  for (const Rung& rung : rungs) {
    add(0, rung.dt, rung.trajectory);
    for (size_t k = 0; k < results.figure_names.size(); ++k)
      if (k < rung.figures.size() && k < rungs.back().figures.size())
        add(k + 1, rung.dt, std::abs(rung.figures[k] / rungs.back().figures[k] - 1));
  }
  std::set<double> steps;
  for (const Rung& rung : rungs) steps.insert(rung.dt);
  if (xs.empty() || steps.size() < 2) return;
  script.begin("truth");
  script.set("key below Left reverse noenhanced");
  script.log_axis('x', "time step, s", log_range(xs), true);
  script.log_axis('y', "change", log_range(ys));
  static const char* const kColours[] = {"#0072b2", "#d55e00", "#00875f", "#aa4499", "#332288", "#7a6a00"};
  for (size_t k = 0; k < lines.size(); ++k)
    script.plot(
        lines[k].second, lines[k].first,
        fmt::format("linespoints pt {} ps 1 lw 1.2 lc '{}'", kPointTypes[k % kSymbols], kColours[k % 6]));
  if (lines[0].second.size() > 1) {
    const auto [dt, change] = lines[0].second.front();
    const double last = lines[0].second.back().first;
    script.plot({{dt, change}, {last, change * last / dt}}, "dt", "lines lw 1.5 dt 3 lc '#000000'");
    script.plot({{dt, change}, {last, change * std::pow(last / dt, 2)}}, "dt^2",
                "lines lw 1.5 dt 2 lc '#000000'");
  }
  script.end();
}

}  // namespace

std::vector<std::string> write_charts(const Results& results, const std::string& directory) {
  make_directory(directory);
  Script script(directory);
  const std::vector<Measure> errors = error_measures(results), speeds = speed_measures(results);
  for (const Measure& error : errors)
    for (const Measure& speed : speeds) draw_error_speed(results, error, speed, script);
  for (const Parameter& parameter : swept_parameters(results))
    for (const Measure& error : errors) draw_parameter(results, parameter, error, script);
  draw_truth(results, script);
  if (script.files().empty()) return {};
  run_gnuplot(Scratch(), script.text());
  for (const std::string& file : script.files())
    if (!std::filesystem::exists(std::filesystem::path(directory) / file))
      throw std::runtime_error(fmt::format("gnuplot made no {}/{}", directory, file));
  return script.files();
}

}  // namespace cuboct::study
