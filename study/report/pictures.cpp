// SPDX-License-Identifier: MIT
// The charts by gnuplot: one script draws all, each once as PNG and once as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "model/base/gnuplot.h"
#include "model/base/output.h"
#include "model/base/text.h"
#include "study/report/chart.h"
#include "study/report/page.h"
#include "study/sweep/series.h"

namespace cuboct::study {
namespace {

constexpr size_t kLongName = 24;  // letters

// gnuplot's point types that look like the page's symbols, and the ring around the best.
constexpr int kPointTypes[kSymbols + 1] = {7, 5, 9, 13, 11, 15, 2}, kRing = 6;
// A point of size 1 is so many pixels across.
constexpr double kPointSize = 9;
// By Stroke.
constexpr int kDashes[] = {0, 1, 2, 3};

std::string axis_text(char name, const ChartAxis& axis) {
  std::string tics;
  for (const Tick& tick : axis.ticks)
    tics += fmt::format("{}{} {}", tics.empty() ? "" : ", ", gnuplot_text(tick.label), tick.at);
  const int decades = axis.decades ? static_cast<int>(std::lround(std::log10(axis.high / axis.low))) : 0;
  for (int k = 0; k < decades; ++k)
    for (int digit = 2; digit <= 9; ++digit)
      tics += fmt::format(", '' {} 1", digit * axis.low * std::pow(10, k));
  return fmt::format("{}set {}label {}\nset {}range [{}:{}]\nset {}tics noenhanced ({})\n",
                     axis.logarithmic ? fmt::format("set logscale {}\n", name) : "", name,
                     gnuplot_label(axis.label), name, axis.low, axis.high, name, tics);
}

// Names that take half of the width beside the chart stand below it.
std::string key_text(const Chart& chart) {
  const bool is_long =
      std::ranges::any_of(chart.plotted, [](const Plotted& p) { return p.name.size() > kLongName; });
  return fmt::format("set key {} Left reverse noenhanced samplen 2 spacing 1.15\n",
                     is_long ? "below" : "outside right top");
}

std::string band_text(const Chart& chart) {
  if (!chart.band) return "";
  return fmt::format(
      "set object 1 rectangle from graph 0,first {0} to graph 1,first {1} behind fillstyle solid noborder "
      "fillcolor '#e8e8e8'\n"
      "set label 1 {2} at graph {3},first {0} {4} offset 0,0.6 textcolor '#555555'\n",
      chart.y.low, chart.band->high, gnuplot_label(chart.band->text), chart.corner_left ? 0.99 : 0.01,
      chart.corner_left ? "right" : "left");
}

std::string corner_text(const Chart& chart) {
  if (chart.corner.empty()) return "";
  return fmt::format("set label 2 {} at graph {},0.03 {} textcolor '#333333'\n", gnuplot_label(chart.corner),
                     chart.corner_left ? 0.01 : 0.99, chart.corner_left ? "left" : "right");
}

// Places in twos, a place of nan after each (study/report/chart.h).
bool are_bars(const Plotted& plotted) {
  return plotted.places.size() > 2 && std::isnan(plotted.places[2].first);
}

std::string style_of(const Plotted& plotted) {
  if (are_bars(plotted)) return fmt::format("vectors nohead lw {} lc '{}'", plotted.width, plotted.colour);
  const bool marks = plotted.symbol >= 0, line = plotted.stroke != Stroke::none;
  std::string style = marks && line ? "linespoints" : marks ? "points" : "lines";
  if (marks) style += fmt::format(" pt {} ps {:.2g}", kPointTypes[plotted.symbol], plotted.size / kPointSize);
  if (line) style += fmt::format(" lw {} dt {}", plotted.width, kDashes[static_cast<size_t>(plotted.stroke)]);
  return style + fmt::format(" lc '{}'", plotted.colour);
}

// A plot command, and before it the data that it reads.
struct Plot {
  const Chart& chart;
  std::string data = {}, command = {};
  std::vector<std::string> named = {};
  int blocks = 0;

  // A blank line ends a line that joins points.
  void add_line(const std::vector<Place>& places) {
    for (const auto& [x, y] : places) data += fmt::format("{} {}\n", x, y);
    data += "\n";
  }
  // Lines apart from one another, each of two places.
  void add_bars(const std::vector<Place>& places) {
    for (size_t k = 0; k + 1 < places.size(); k += 3)
      data += fmt::format("{} {} {} {}\n", places[k].first, places[k].second,
                          places[k + 1].first - places[k].first, places[k + 1].second - places[k].second);
  }
  void add_rows(const Rows& rows) {
    std::vector<Place> places;
    for (const size_t row : rows)
      places.emplace_back(chart.x.place(chart.x.values[row]), chart.y.place(chart.y.values[row]));
    add_line(places);
  }
  void add(const Plotted& plotted, const std::string& style) {
    std::string what = "keyentry";
    if (!plotted.rows.empty() || !plotted.places.empty()) {
      what = fmt::format("$data{}", blocks++);
      data += what + " << END\n";
      for (const Rows& rows : plotted.rows) add_rows(rows);
      if (are_bars(plotted))
        add_bars(plotted.places);
      else
        add_line(plotted.places);
      data += "END\n";
    }
    const bool titled = !plotted.name.empty() && std::ranges::find(named, plotted.name) == named.end();
    if (titled) named.push_back(plotted.name);
    command += fmt::format("{}{} with {} {}", command.empty() ? "plot " : ", ", what, style,
                           titled ? "title " + gnuplot_label(plotted.name) : "notitle");
  }
};

}  // namespace

std::vector<std::string> write_charts(const Results& results, const std::string& directory) {
  return write_charts(charts_of(results), directory);
}

std::vector<std::string> write_charts(const std::vector<Chart>& charts, const std::string& directory) {
  make_directory(directory);
  std::string script = "set encoding utf8\n";
  std::vector<std::string> files;
  for (const Chart& chart : charts) {
    Plot plot{chart};
    for (const Plotted& plotted : chart.plotted) plot.add(plotted, style_of(plotted));
    if (!chart.best.empty()) {
      Plotted rings;
      rings.rows = {chart.best};
      plot.add(rings, fmt::format("points pt {} ps 1.7 lw 1.5 lc '#222222'", kRing));
    }
    script += "reset\n" + plot.data +
              "set border 3 lc '#444444'\nset tics nomirror\nset grid lc '#dddddd' lt 1 lw 0.5\n" +
              fmt::format("set title {} font ',12'\n", gnuplot_label(chart.title)) + key_text(chart) +
              axis_text('x', chart.x) + axis_text('y', chart.y) + band_text(chart) + corner_text(chart);
    for (const auto& [ending, terminal] : {std::pair{".png", "pngcairo size 1100,680 font 'Helvetica,13'"},
                                           {".svg", "svg size 1100,680 dynamic font 'Helvetica,14'"}}) {
      files.push_back(chart.id + ending);
      script += fmt::format("set terminal {} background '#ffffff'\nset output {}\n{}\n", terminal,
                            gnuplot_file(directory + "/" + files.back()), plot.command);
    }
  }
  if (files.empty()) return {};
  run_gnuplot(Scratch(), script);
  for (const std::string& file : files)
    if (!std::filesystem::exists(std::filesystem::path(directory) / file))
      throw std::runtime_error(fmt::format("gnuplot made no {}/{}", directory, file));
  return files;
}

}  // namespace cuboct::study
