// SPDX-License-Identifier: MIT
#include "model/trace/raster_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/base/error.h"
#include "model/base/gnuplot.h"
#include "model/base/output.h"
#include "model/base/process.h"
#include "model/base/spelling.h"
#include "model/base/text.h"
#include "model/trace/render.h"

namespace cuboct {
namespace {

struct Shown {
  double factor;  // from SI to what the bar counts in
  std::string label;
};

struct Unit {
  double factor;
  const char* name;
};

// In which `value` reads as 1 ... 1000.
Unit readable(double value, const std::array<Unit, 4>& units) {
  for (const Unit& unit : units)
    if (value * unit.factor >= 1) return unit;
  return units.back();
}

constexpr std::array<Unit, 4> kLengths{{{1, "m"}, {1e3, "mm"}, {1e6, "µm"}, {1e9, "nm"}}};
constexpr std::array<Unit, 4> kTimes{{{1, "s"}, {1e3, "ms"}, {1e6, "µs"}, {1e9, "ns"}}};

bool is_seen(const Rasters& rasters, const Raster& frame, size_t pixel) {
  return frame.thickness[pixel] > 0.2 * particle_thickness(rasters.particle);
}

std::vector<float> Raster::*values_of(Field field) {
  constexpr std::array values{&Raster::strain, &Raster::speed, &Raster::thickness, &Raster::broken};
  return values[static_cast<size_t>(field)];
}

// kDiverging, as gnuplot wants it.
std::string diverging_palette() {
  std::string text;
  for (const Anchor& one : kDiverging)
    text += fmt::format("{}{} '#{:02x}{:02x}{:02x}'", text.empty() ? "" : ", ", one.at, one.colour[0],
                        one.colour[1], one.colour[2]);
  return text;
}

// Screen pixels around and between the panels.
constexpr int kTitle = 44, kLabel = 26, kTics = 34, kLeft = 62, kRight = 18, kBar = 96;

}  // namespace

Field field_of(const std::string& name) {
  static const std::vector<std::string> kNames{"strain", "speed", "thickness", "broken"};
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found != kNames.end()) return static_cast<Field>(found - kNames.begin());
  const std::string near = did_you_mean(name, kNames);
  throw InputError(fmt::format("unknown field '{}'", name),
                   near.empty() ? "strain, speed, thickness and broken can be drawn" : near);
}

double usual_limit(std::vector<float> all) {
  if (all.empty()) return 0;
  const auto end = all.begin() + static_cast<ptrdiff_t>(all.size() * 90 / 100);
  std::nth_element(all.begin(), end, all.end());
  return *end;
}

// The few pixels that a crack parts would else take the whole scale.
double usual_limit(const Rasters& rasters, Field field) {
  std::vector<float> all;
  for (const Raster& frame : rasters.frames) {
    const std::vector<float>& values = frame.*values_of(field);
    for (size_t pixel = 0; pixel < rasters.grid.pixels(); ++pixel)
      if (is_seen(rasters, frame, pixel) && std::isfinite(values[pixel]) &&
          (field != Field::broken || values[pixel] > 0))
        all.push_back(std::abs(values[pixel]));
  }
  return usual_limit(std::move(all));
}

std::vector<size_t> spread_frames(size_t count) {
  std::vector<size_t> chosen;
  for (size_t k = 0; k < 4 && count > 0; ++k)
    if (const size_t at = k * (count - 1) / 3; chosen.empty() || chosen.back() != at) chosen.push_back(at);
  return chosen;
}

std::string plot_rasters(const Rasters& rasters, const RasterPicture& picture) {
  const RasterGrid& grid = rasters.grid;
  const Unit length = readable(std::max(grid.columns, grid.rows) * grid.pixel, kLengths);
  Shown shown = picture.field == Field::strain
                    ? Shown{100, fmt::format("axial strain along {}, %", "xyz"[rasters.strain_axis])}
                : picture.field == Field::speed ? Shown{1, "speed, m/s"}
                : picture.field == Field::broken
                    ? Shown{1, "broken bonds per particle"}
                    : Shown{length.factor, fmt::format("thickness, {}", length.name)};
  double limit = picture.limit > 0 ? picture.limit : usual_limit(rasters, picture.field);
  limit = std::max(limit * shown.factor, 1e-9);
  if (picture.limit == 0) shown.label += " (colours end at the 90th percentile of all frames)";

  const int panels = static_cast<int>(picture.frames.size());
  const int across = panels > 1 && grid.columns < 3 * grid.rows ? 2 : 1,
            down = (panels + across - 1) / across;
  // A tall body gets narrower panels, so that the picture is at most twice as high as wide.
  const double shape = static_cast<double>(grid.rows) / grid.columns;
  const int most = (2 * picture.width - kTitle - kBar) / down - kLabel - kTics;
  const int widest = picture.width / across - kLeft - kRight;
  const int wide = std::max(1, static_cast<int>(std::min<double>(widest, most / shape)));
  const int high = std::max(1, static_cast<int>(std::lround(wide * shape)));
  const int row = kLabel + high + kTics, height = kTitle + down * row + kBar;
  const double px = grid.pixel * length.factor;
  const double left = grid.left * length.factor, bottom = grid.bottom * length.factor;

  const Scratch scratch;
  const auto x = [&](int pixel) { return static_cast<double>(pixel) / picture.width; };
  const auto y = [&](int from_top) { return 1 - static_cast<double>(from_top) / height; };
  std::string script = fmt::format(
      "set encoding utf8\nset terminal pngcairo size {},{} font 'Helvetica,13' background '#ffffff'\n"
      "set output {}\nset multiplot\nunset key\nunset colorbox\n"
      "set label 2 {} at screen 0.5,{:.6f} center font 'Helvetica,16'\n"
      "set palette defined ({})\nset cbrange [{:.9g}:{:.9g}]\n"
      "set border 15 lc '#888888'\nset tics out nomirror\nset xrange [{:.9g}:{:.9g}]\nset yrange "
      "[{:.9g}:{:.9g}]\n",
      picture.width, height, gnuplot_file(scratch.path("plot.png")), gnuplot_label(rasters.title),
      y(kTitle / 2),
      picture.field == Field::strain
          ? diverging_palette()
          : std::string("0 '#440154', 1 '#472c7a', 2 '#3b518b', 3 '#2c718e', 4 '#21908d', 5 "
                        "'#27ad81', 6 '#5cc863', 7 '#aadc32', "
                        "8 '#fde725'"),
      picture.field == Field::strain ? -limit : 0, limit, left, left + grid.columns * px, bottom,
      bottom + grid.rows * px);
  for (int n = 0; n < panels; ++n) {
    const Raster& frame = rasters.frames[picture.frames[static_cast<size_t>(n)]];
    std::vector<float> values(grid.pixels());
    for (size_t pixel = 0; pixel < values.size(); ++pixel)
      values[pixel] = is_seen(rasters, frame, pixel)
                          ? static_cast<float>((frame.*values_of(picture.field))[pixel] * shown.factor)
                          : std::numeric_limits<float>::quiet_NaN();
    const std::string name = scratch.path(fmt::format("panel{}", n));
    write_text(name,
               std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)));
    const int from_left = n % across * (picture.width / across) + kLeft;
    const int from_top = kTitle + n / across * row + kLabel;
    const Unit time = readable(frame.time, kTimes);
    script += fmt::format(
        "set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\nset tmargin at screen {:.6f}\n"
        "set bmargin at screen {:.6f}\nset label 1 'step {},  t = {:.4g} {}' at screen {:.6f},{:.6f} front\n"
        "set ylabel '{}, {}' offset 1.5\nset label 3 '{}, {}' at screen {:.6f},{:.6f} right front\n"
        "plot {} binary array=({},{}) format='%float' dx={:.9g} dy={:.9g} origin=({:.9g},{:.9g}) with image\n"
        "unset label 2\n",
        x(from_left), x(from_left + wide), y(from_top), y(from_top + high), frame.step,
        frame.time * time.factor, time.name, x(from_left), y(from_top - kLabel / 2), "xyz"[grid.up],
        length.name, "xyz"[grid.right], length.name, x(from_left + wide), y(from_top - kLabel / 2),
        gnuplot_file(name), grid.columns, grid.rows, px, px, left + px / 2, bottom + px / 2);
  }
  // The bar: a raster of the same palette.
  std::vector<float> bar;
  const double low = picture.field == Field::strain ? -limit : 0;
  for (int k = 0; k < 512; ++k) bar.push_back(static_cast<float>(low + (limit - low) * (k % 256) / 255));
  write_text(scratch.path("bar"),
             std::string(reinterpret_cast<const char*>(bar.data()), bar.size() * sizeof(float)));
  script += fmt::format(
      "unset label 1\nunset label 3\nunset ylabel\nunset ytics\nset lmargin at screen 0.25\nset rmargin at "
      "screen "
      "0.75\nset tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\nset xlabel {}\n"
      "set xrange [{:.9g}:{:.9g}]\nset yrange [0:1]\n"
      "plot {} binary array=(256,2) format='%float' dx={:.9g} dy=1 origin=({:.9g},0) with image\n"
      "unset multiplot\n",
      y(height - kBar + 10), y(height - kBar + 28), gnuplot_label(shown.label), low, limit,
      gnuplot_file(scratch.path("bar")), (limit - low) / 255, low);
  run_gnuplot(scratch, script);
  return read_text(scratch.path("plot.png"));
}

}  // namespace cuboct
