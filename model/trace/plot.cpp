// SPDX-License-Identifier: MIT
#include "model/trace/plot.h"

#include <fmt/format.h>

#include "model/base/gnuplot.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/text.h"

namespace cuboct {
namespace {

void write_raw(const std::string& path, const Image& image) {
  write_text(path, std::string(reinterpret_cast<const char*>(image.pixels.data()), 3 * image.pixels.size()));
}

}  // namespace

std::string plot_lines(const std::vector<Series>& series, const std::string& x_label,
                       const std::string& y_label) {
  static const char* const kColours[] = {"#1f5fa8", "#c8501e", "#2a8a55", "#7a4fa0"};
  const Scratch scratch;
  std::string script = fmt::format(
      "set terminal svg size 640,360 dynamic font 'Helvetica,15' background '#ffffff'\n"
      "set output {}\n"
      "set border 3 lc '#444444'\nset tics nomirror\nset grid lc '#dddddd' lt 1\nset key above\n"
      "set xlabel {}\nset ylabel {}\nplot ",
      gnuplot_file(scratch.path("plot.svg")), gnuplot_label(x_label), gnuplot_label(y_label));
  for (size_t i = 0; i < series.size(); ++i) {
    std::string points, marks;
    for (size_t k = 0; k < series[i].x.size(); ++k)
      points += fmt::format("{:.9g} {:.9g}\n", series[i].x[k], series[i].y[k]);
    for (const auto& [x, y] : series[i].marks) marks += fmt::format("{:.9g} {:.9g}\n", x, y);
    const std::string name = scratch.path(fmt::format("series{}", i));
    write_text(name, points);
    script += fmt::format(
        "{}{} with lines lw {} lc '{}' {}", i > 0 ? ", " : "", gnuplot_file(name), series[i].faint ? 1 : 2,
        series[i].faint ? "#bbbbbb" : kColours[i % 4],
        series[i].title.empty() ? "notitle" : fmt::format("title {}", gnuplot_label(series[i].title)));
    if (!marks.empty()) {
      write_text(name + ".marks", marks);
      script += fmt::format(", {} with points pt 7 ps 0.8 lc '{}' title 'pictures above'",
                            gnuplot_file(name + ".marks"), kColours[1]);
    }
  }
  run_gnuplot(scratch, script + "\n");
  const std::string svg = read_text(scratch.path("plot.svg"));
  const size_t begin = svg.find("<svg");
  if (begin == std::string::npos) throw std::runtime_error("gnuplot made no SVG");
  return svg.substr(begin);
}

std::string plot_pictures(const std::vector<Image>& pictures, const std::vector<std::string>& labels,
                          const std::string& bar_label, double limit) {
  // Letters of 24 pixels in a picture of 1100: they can be read where a page shows it 400 wide.
  constexpr int kLabel = 44, kBar = 180;
  const Scratch scratch;
  const int width = pictures[0].width, row = pictures[0].height + kLabel;
  const int height = static_cast<int>(pictures.size()) * row + kBar;
  const auto y = [&](int from_top) { return 1 - static_cast<double>(from_top) / height; };
  std::string script = fmt::format(
      "set terminal pngcairo size {},{} font 'Helvetica,24' background '#ffffff'\nset output {}\n"
      "set multiplot\nunset key\nunset border\nunset tics\n",
      width, height, gnuplot_file(scratch.path("plot.png")));
  for (size_t i = 0; i < pictures.size(); ++i) {
    const std::string name = scratch.path(fmt::format("picture{}", i));
    write_raw(name, pictures[i]);
    const int top = static_cast<int>(i) * row;
    script += fmt::format(
        "set lmargin at screen 0\nset rmargin at screen 1\nset tmargin at screen {:.6f}\nset bmargin at "
        "screen {:.6f}\n"
        "set label 1 {} at screen 0.012,{:.6f} front\n"
        "set xrange [0:{}]\nset yrange [0:{}]\n"
        "plot {} binary array=({},{}) flipy format='%uchar' using 1:2:3 with rgbimage\n",
        y(top + kLabel), y(top + row), gnuplot_label(labels[i]), y(top + kLabel / 2), width - 1,
        pictures[i].height - 1, gnuplot_file(name), width, pictures[i].height);
  }
  Image bar{256, 2, {}};  // gnuplot draws no image of one row
  for (int k = 0; k < 512; ++k) bar.pixels.push_back(diverging(k % 256 / 127.5 - 1));
  write_raw(scratch.path("bar"), bar);
  script += fmt::format(
      "unset label 1\nset lmargin at screen 0.15\nset rmargin at screen 0.85\n"
      "set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n"
      "set border 15 lc '#444444'\nset xtics out nomirror\nset xlabel {}\n"
      "set xrange [{:.9g}:{:.9g}]\nset yrange [0:1]\n"
      "plot {} binary array=(256,2) format='%uchar' dx={:.9g} dy=1 origin=({:.9g},0) using 1:2:3 with "
      "rgbimage\n"
      "unset multiplot\n",
      y(height - kBar + 14), y(height - kBar + 40), gnuplot_label(bar_label), -limit, limit,
      gnuplot_file(scratch.path("bar")), limit / 127.5, -limit);
  run_gnuplot(scratch, script);
  return read_text(scratch.path("plot.png"));
}

std::string gnuplot(const std::string& data, const std::string& plot, const std::string& kind, int width,
                    int height) {
  const Scratch scratch;
  const std::string out = scratch.path("plot." + kind);
  const std::string terminal = kind == "svg"
                                   ? fmt::format("svg size {},{} dynamic font 'Helvetica,14'", width, height)
                                   : fmt::format("pngcairo size {},{} font 'Helvetica,13'", width, height);
  run_gnuplot(scratch,
              fmt::format("{}set encoding utf8\nset terminal {} background '#ffffff'\nset output {}\n{}",
                          data, terminal, gnuplot_file(out), plot));
  return read_text(out);
}

void draw_plot(const std::string& path, const std::string& data, const std::string& plot, int width,
               int height) {
  write_text(path, gnuplot(data, plot, path.substr(path.size() - 3), width, height));
}

std::string plot_block(const std::string& name, const std::string& rows) {
  return fmt::format("${} << END\n{}END\n", name, rows);
}

}  // namespace cuboct
