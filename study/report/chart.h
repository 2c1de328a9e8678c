// SPDX-License-Identifier: MIT
// A report's charts as data: which there are, what stands on their axes, in which ranges, order and colours.
// study/report/web/charts.js draws them on the page and study/report/pictures.cpp by gnuplot; neither knows
// one by name.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/sweep/store.h"

namespace cuboct::study {

struct Tick {
  double at = 0;
  std::string label;
};

struct ChartAxis {
  std::string label;
  std::vector<double> values;  // of the chart's rows; nan: none
  bool logarithmic = false;    // a value of 0 stands at `low`
  bool decades = false;        // powers of ten are the ticks, with parts between
  double low = 0, high = 1;
  std::vector<Tick> ticks;

  double place(double value) const { return logarithmic && value == 0 ? low : value; }
};

enum class Stroke : uint8_t { none, solid, dashed, dotted };

using Rows = std::vector<size_t>;
using Place = std::pair<double, double>;  // x, y

// Marks, a line, or marks that lines join.
struct Plotted {
  std::string name;    // the key has the first of each name
  std::string colour;  // "#0072b2"
  int symbol = -1;     // as Series::symbol, or kCross; -1: none
  double size = 0;     // of the symbol, in pixels
  Stroke stroke = Stroke::none;
  double width = 0;           // of the line, in pixels
  std::vector<Rows> rows;     // joined each by itself, or
  std::vector<Place> places;  // a line through no row, or bars: two places each and one of nan after them;
                              // without a key a line's name stands beside its middle place
};

// The part of the chart below `high`.
struct ChartBand {
  double high = 0;
  std::string text;
};

struct Chart {
  std::string id;                      // of [a-z0-9_-]: its picture's name
  std::string section;                 // of the page: an element's id in page.html
  std::optional<size_t> error, speed;  // of the measures that the reader chooses; none: shown with all
  std::string title, caption;
  ChartAxis x, y;
  std::vector<Plotted> plotted;  // the last on top
  Rows best;                     // that stand out
  std::optional<ChartBand> band;
  std::string corner;  // names the better one, the lower left or right
  bool corner_left = false;
  bool key = true;
  std::vector<std::string> tips;  // of each row; empty: rows are the study's points, which the page describes
};

// Each error against each speed, each error against each varied setting, the truth's refinement: those that
// have something to draw.
std::vector<Chart> charts_of(const Results& results);

}  // namespace cuboct::study
