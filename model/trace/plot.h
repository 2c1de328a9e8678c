// SPDX-License-Identifier: MIT
// Figures by gnuplot.
#pragma once

#include <string>
#include <vector>

#include "model/trace/render.h"

namespace cuboct {

struct Series {
  std::string title;
  std::vector<double> x, y;
  std::vector<std::pair<double, double>> marks;  // points to stand out
  bool faint = false;                            // a thin grey line, behind what is drawn later
};

// An SVG element, ready to stand in HTML.
std::string plot_lines(const std::vector<Series>& series, const std::string& x_label,
                       const std::string& y_label);

// Pictures of one size under one another, each with its label, above a bar that maps [-limit, limit] to
// `diverging`. PNG bytes.
std::string plot_pictures(const std::vector<Image>& pictures, const std::vector<std::string>& labels,
                          const std::string& bar_label, double limit);

// What gnuplot draws by `plot`, with `data` (its here-documents) before it: the file's bytes. `kind`: "png"
// or "svg".
std::string gnuplot(const std::string& data, const std::string& plot, const std::string& kind, int width,
                    int height);
// The same into a file, whose ending is the kind.
void draw_plot(const std::string& path, const std::string& data, const std::string& plot, int width,
               int height);
// Of `data` the rows that the plot calls "$name".
std::string plot_block(const std::string& name, const std::string& rows);
// How most charts look.
inline constexpr const char* kPlotStyle = "set grid lc '#dddddd' lt 1\nset border 3\nset tics nomirror\n";

}  // namespace cuboct
