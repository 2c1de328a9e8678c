// SPDX-License-Identifier: MIT
#include "study/stability/stability_pictures.h"

#include <fmt/format.h>

#include <cmath>

#include "model/base/output.h"
#include "model/base/text.h"
#include "model/trace/plot.h"

namespace cuboct::study {

std::vector<std::string> draw(const StabilityMap& map, const std::string& directory) {
  static const char* const kColours[] = {"#cfe3f5", "#d9703f", "#b9b9b9", "#6f6f6f"};
  static const char* const kNames[] = {"stable", "unstable", "the formats refuse it",
                                       "the body itself is unstable"};
  std::string data = "$cells << END\n";
  std::string colours, keys;
  bool there[4] = {};
  for (size_t k = 0; k < map.y.size(); ++k)
    for (size_t i = 0; i < map.x.size(); ++i) {
      const auto cell = static_cast<size_t>(map.cells[k * map.x.size() + i]);
      there[cell] = true;
      data += fmt::format("{:.9g} {:.9g} {}\n", map.x[i], map.y[k], cell);
    }
  data += "END\n$theory << END\n";
  for (size_t i = 0; i < map.x.size(); ++i)
    if (std::isfinite(map.theory[i])) data += fmt::format("{:.9g} {:.9g}\n", map.x[i], map.theory[i]);
  data += "END\n";
  for (size_t c = 0; c < 4; ++c) {
    colours += fmt::format("{}{} '{}'", c > 0 ? ", " : "", c, kColours[c]);
    if (there[c])
      keys += fmt::format(", NaN with points pt 5 ps 2 lc rgb '{}' title '{}'", kColours[c], kNames[c]);
  }
  const double dx = (map.x[1] - map.x[0]) / 2, dy = (map.y[1] - map.y[0]) / 2;
  // As rectangles an SVG has no file inside; a PNG would show their seams.
  const auto plot = [&](const std::string& kind) {
    return fmt::format(
        "set border 3 lc '#444444'\nset tics nomirror out\nset key tmargin center horizontal samplen 2\n"
        "set title {}\nset xlabel {}\nset ylabel 'dt over 2/ω_{{max}} of the free, undamped body'\n"
        "set xrange [{:.9g}:{:.9g}]\nset yrange [{:.9g}:{:.9g}]\n"
        "set palette defined ({})\nset cbrange [0:3]\nunset colorbox\n"
        "plot $cells using 1:2:3 with image {} notitle{}, $theory with lines lw 3 lc rgb '#111111' title "
        "'theory'\n",
        gnuplot_label(map.title), gnuplot_label(map.x_label), map.x.front() - dx, map.x.back() + dx,
        map.y.front() - dy, map.y.back() + dy, colours, kind == "svg" ? "pixels" : "", keys);
  };
  std::vector<std::string> names;
  for (const char* kind : {"png", "svg"}) {
    const std::string path = fmt::format("{}/{}.{}", directory, map.name, kind);
    draw_plot(path, data, plot(kind), 760, 560);
    names.push_back(path);
  }
  return names;
}

}  // namespace cuboct::study
