// SPDX-License-Identifier: MIT
#include "model/trace/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "model/base/output.h"
#include "model/trace/hdf5_file.h"

namespace cuboct {
namespace {

constexpr char kRasterFormat[] = "cuboct rasters";
// Along an axis, of what is read; twice what a run writes of its longest, whose ends may fly apart.
constexpr hsize_t kMostPixels = 1 << 16;
constexpr uint32_t kRasterVersion = 3;
constexpr double kTouch = 1e-6;  // pixels: rounding, at the edge of a pixel

struct Extent {
  Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
  void add(const Vec3& x) { lower = lower.cwiseMin(x), upper = upper.cwiseMax(x); }
};

// The nearest float of 11 significant bits; subnormals become 0.
float rounded(float value) {
  constexpr int kDropped = 24 - 11;
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const uint32_t near = (bits + (uint32_t{1} << (kDropped - 1))) & ~((uint32_t{1} << kDropped) - 1);
  return std::abs(value) < std::numeric_limits<float>::min() ? 0 : std::bit_cast<float>(near);
}

}  // namespace

RasterGrid raster_grid(const Frame& first, double radius, uint32_t across) {
  if (first.x.empty()) throw InputError("a picture needs particles");
  Extent body;
  for (const Vec3& x : first.x) body.add(x);
  const Vec3 extent = body.upper - body.lower;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return extent[a] > extent[b]; });
  RasterGrid grid;
  grid.right = order[0];
  grid.up = order[1];
  const double longest = extent[grid.right] + 2 * radius;
  grid.pixel = std::max(longest / across, radius / 2);
  // Whole pixels on all sides, so that the body's lower left corner is one of a pixel.
  const double margin = std::ceil(longest / 2 / grid.pixel) * grid.pixel;
  grid.left = body.lower[grid.right] - radius - margin;
  grid.bottom = body.lower[grid.up] - radius - margin;
  const auto pixels = [&](int axis) {
    const double wide = (extent[axis] + 2 * radius + 2 * margin) / grid.pixel;
    return static_cast<uint32_t>(std::ceil(wide * (1 - 1e-12)));
  };
  grid.columns = pixels(grid.right);
  grid.rows = pixels(grid.up);
  return grid;
}

namespace {

// Lower left corner of a particle's square in pixels; nothing where the grid does not hold it.
std::optional<std::array<double, 2>> corner(const Vec3& x, const RasterGrid& grid, double side) {
  const std::array<double, 2> at{(x[grid.right] - grid.left) / grid.pixel - side / 2,
                                 (x[grid.up] - grid.bottom) / grid.pixel - side / 2};
  // Particles at the grid's edge touch it to within rounding.
  if (at[0] >= -kTouch && at[1] >= -kTouch && at[0] + side <= grid.columns + kTouch &&
      at[1] + side <= grid.rows + kTouch)
    return at;
  return std::nullopt;
}

}  // namespace

RasterWindow window_of(const Frame& frame, const RasterGrid& grid, double radius) {
  const double side = 2 * radius / grid.pixel;
  RasterWindow all;
  for (const Vec3& x : frame.x)
    if (const auto at = corner(x, grid, side)) {
      const auto first = [](double from) {
        return static_cast<uint32_t>(std::max(0.0, std::floor(from + kTouch)));
      };
      const auto count = [&](double from, uint32_t limit) {
        return std::min(limit, static_cast<uint32_t>(std::ceil(from + side - kTouch))) - first(from);
      };
      all = join(
          all, {first((*at)[0]), first((*at)[1]), count((*at)[0], grid.columns), count((*at)[1], grid.rows)});
    }
  return all;
}

RasterWindow join(const RasterWindow& a, const RasterWindow& b) {
  if (a.columns == 0) return b;
  if (b.columns == 0) return a;
  const uint32_t column = std::min(a.column, b.column), row = std::min(a.row, b.row);
  return {column, row, std::max(a.column + a.columns, b.column + b.columns) - column,
          std::max(a.row + a.rows, b.row + b.rows) - row};
}

RasterGrid part_of(const RasterGrid& grid, const RasterWindow& window) {
  RasterGrid part = grid;
  part.left += window.column * grid.pixel;
  part.bottom += window.row * grid.pixel;
  part.columns = window.columns;
  part.rows = window.rows;
  return part;
}

Raster rasterise(const Frame& frame, const RasterGrid& grid, double radius) {
  std::vector<double> thickness(grid.pixels(), 0), strain = thickness, speed = thickness, broken = thickness;
  Raster raster{frame.step, frame.time, {}, {}, {}, {}, 0};
  const double side = 2 * radius / grid.pixel;  // pixels
  // Of the volume side^2 * particle_thickness, what a whole pixel holds.
  const double full = particle_thickness(2 * radius);
  for (size_t i = 0; i < frame.x.size(); ++i) {
    const auto at = corner(frame.x[i], grid, side);
    if (!at) {
      ++raster.outside;
      continue;
    }
    const auto [x, y] = *at;
    const double v = frame.v[i].norm(), bonds = frame.broken.empty() ? 0 : frame.broken[i];
    const auto first = [](double at) { return static_cast<uint32_t>(std::max(0.0, std::floor(at))); };
    const auto last = [&](double at, uint32_t count) { return std::min(count, first(at + side) + 1); };
    const auto share = [&](uint32_t pixel, double at) {
      return std::max(0.0, std::min(pixel + 1.0, at + side) - std::max(static_cast<double>(pixel), at));
    };
    for (uint32_t row = first(y); row < last(y, grid.rows); ++row)
      for (uint32_t column = first(x); column < last(x, grid.columns); ++column) {
        const size_t pixel = size_t{row} * grid.columns + column;
        const double part = share(row, y) * share(column, x) * full;
        thickness[pixel] += part;
        strain[pixel] += part * frame.strain[i];
        speed[pixel] += part * v;
        broken[pixel] += part * bonds;
      }
  }
  raster.thickness.reserve(grid.pixels());
  raster.strain.reserve(grid.pixels());
  raster.speed.reserve(grid.pixels());
  raster.broken.reserve(grid.pixels());
  for (size_t at = 0; at < grid.pixels(); ++at) {
    const double over = thickness[at] > 0 ? 1 / thickness[at] : 0;
    raster.thickness.push_back(static_cast<float>(thickness[at]));
    raster.strain.push_back(static_cast<float>(strain[at] * over));
    raster.speed.push_back(static_cast<float>(speed[at] * over));
    raster.broken.push_back(static_cast<float>(broken[at] * over));
  }
  return raster;
}

struct RasterWriter::Impl {
  static constexpr uint32_t kTile = 64;        // pixels along a chunk's edges
  static constexpr uint64_t kSlack = 1 << 16;  // bytes of the disk for a frame's share of indices and headers

  Impl(const std::string& path, const std::string& temporary, const Rasters& head, uint32_t across)
      : path(path), temporary(temporary), head(head), across(across), out(temporary, path) {}

  hdf5::Handle field(const char* name, const char* unit) const {
    return out.growing<float>(out.root(), name, {0, grid.rows, grid.columns},
                              {1, std::min(kTile, grid.rows), std::min(kTile, grid.columns)}, true, unit,
                              "[frame][row][column]");
  }
  template <typename T>
  hdf5::Handle number(const char* name, const char* unit) const {
    return out.growing<T>(out.root(), name, {0}, {1 << 10}, false, unit, "[frame]");
  }

  void start(const Frame& frame) {
    grid = raster_grid(frame, head.particle / 2, across);
    sets.push_back(number<uint64_t>("step", ""));
    sets.push_back(number<double>("time", "s"));
    sets.push_back(number<uint64_t>("outside", "particles"));
    sets.push_back(field("thickness", "m"));
    sets.push_back(field("strain", "1"));
    sets.push_back(field("speed", "m/s"));
    sets.push_back(field("broken", "bonds"));
  }

  void add(const Frame& frame) {
    if (sets.empty()) start(frame);
    // Whole tiles: what lies in none of any frame takes no space.
    const RasterWindow touched = window_of(frame, grid, head.particle / 2);
    const auto down = [](uint32_t at) { return at / kTile * kTile; };
    const auto up = [](uint32_t at, uint32_t limit) {
      return std::min(limit, (at + kTile - 1) / kTile * kTile);
    };
    RasterWindow tiles{down(touched.column), down(touched.row), 0, 0};
    tiles.columns = up(touched.column + touched.columns, grid.columns) - tiles.column;
    tiles.rows = up(touched.row + touched.rows, grid.rows) - tiles.row;
    Raster raster = rasterise(frame, part_of(grid, tiles), head.particle / 2);
    const uint64_t pixels = raster.thickness.size();
    out.reserve(4 * (sizeof(float) + 1) * (pixels + kTile * kTile) + kSlack);
    out.write_block<uint64_t>(sets[0], "step", {count + 1}, {count}, {1}, &raster.step);
    out.write_block<double>(sets[1], "time", {count + 1}, {count}, {1}, &raster.time);
    out.write_block<uint64_t>(sets[2], "outside", {count + 1}, {count}, {1}, &raster.outside);
    const auto write = [&](const hdf5::Handle& data, const char* name, std::vector<float>& values) {
      for (float& value : values) value = rounded(value);
      const hdf5::Shape extent{count + 1, grid.rows, grid.columns};
      if (pixels == 0)
        out.extend(data, name, extent);
      else
        out.write_block<float>(data, name, extent, {count, tiles.row, tiles.column},
                               {1, tiles.rows, tiles.columns}, values.data());
    };
    write(sets[3], "thickness", raster.thickness);
    write(sets[4], "strain", raster.strain);
    write(sets[5], "speed", raster.speed);
    write(sets[6], "broken", raster.broken);
    out.flush();
    used = join(used, touched);
    ++count;
  }

  void finish() {
    sets.clear();
    out.reserve(kSlack);
    out.text(out.root(), "format", kRasterFormat);
    out.number<uint32_t>(out.root(), "version", kRasterVersion);
    out.text(out.root(), "title", head.title);
    out.number<uint32_t>(out.root(), "strain_axis", static_cast<uint32_t>(head.strain_axis));
    out.number<uint32_t>(out.root(), "right", static_cast<uint32_t>(grid.right));
    out.number<uint32_t>(out.root(), "up", static_cast<uint32_t>(grid.up));
    for (const auto& [name, value] : {std::pair{"left", grid.left},
                                      {"bottom", grid.bottom},
                                      {"pixel", grid.pixel},
                                      {"particle", head.particle}})
      out.number<double>(out.root(), name, value);
    for (const auto& [name, value] : {std::pair{"column", used.column},
                                      {"row", used.row},
                                      {"columns", used.columns},
                                      {"rows", used.rows}})
      out.number<uint32_t>(out.root(), name, value);
    out.close();
    rename_whole(temporary, path);
  }

  std::string path, temporary;
  Rasters head;
  uint32_t across;
  hdf5::Writer out;
  RasterGrid grid;
  RasterWindow used;
  std::vector<hdf5::Handle> sets;
  uint64_t count = 0;
};

RasterWriter::RasterWriter(const std::string& path, const std::string& temporary, const Rasters& head,
                           uint32_t across)
    : impl_(std::make_unique<Impl>(path, temporary, head, across)) {}

RasterWriter::~RasterWriter() {
  if (!impl_) return;
  const std::string temporary = impl_->temporary;
  impl_.reset();
  discard(temporary);
}

void RasterWriter::add(const Frame& frame) { impl_->add(frame); }

void RasterWriter::leave() { impl_.reset(); }

void RasterWriter::finish() {
  impl_->finish();
  impl_.reset();
}

Rasters read_rasters(const std::string& path) {
  const hdf5::Reader in(path, "rasters file");
  if (!in.has_attribute(in.root(), "format") || in.text(in.root(), "format") != kRasterFormat)
    throw InputError(fmt::format("{} holds no rasters", path),
                     "'cuboct run SCENE --out DIR' makes DIR/rasters.h5");
  if (const auto version = in.number<uint32_t>(in.root(), "version"); version != kRasterVersion)
    throw InputError(
        fmt::format("{} has version {} of the format, this cuboct reads {}", path, version, kRasterVersion));
  Rasters rasters;
  rasters.title = in.text(in.root(), "title");
  RasterGrid& grid = rasters.grid;
  const auto axis = [&](const char* name) {
    const auto value = in.number<uint32_t>(in.root(), name);
    if (value > 2) throw InputError(fmt::format("{}: '{}' is no axis", path, name));
    return static_cast<int>(value);
  };
  rasters.strain_axis = axis("strain_axis");
  grid.right = axis("right");
  grid.up = axis("up");
  grid.left = in.number<double>(in.root(), "left");
  grid.bottom = in.number<double>(in.root(), "bottom");
  grid.pixel = in.number<double>(in.root(), "pixel");
  rasters.particle = in.number<double>(in.root(), "particle");
  for (const auto& [name, value] : {std::pair{"pixel", grid.pixel}, {"particle", rasters.particle}})
    if (!(value > 0) || !std::isfinite(value))
      throw InputError(fmt::format("{}: '{}' must be a length above 0, not {}", path, name, value));
  for (const auto& [name, value] : {std::pair{"left", grid.left}, {"bottom", grid.bottom}})
    if (!std::isfinite(value))
      throw InputError(fmt::format("{}: '{}' must be finite, not {}", path, name, value));
  const auto step = in.array<uint64_t>(in.root(), "step"), outside = in.array<uint64_t>(in.root(), "outside");
  const auto time = in.array<double>(in.root(), "time");
  rasters.frames.resize(step.size());
  const hdf5::Shape shape = in.extent(in.root(), "thickness");
  if (shape.size() != 3) throw InputError(fmt::format("{}: 'thickness' has no rows and columns", path));
  RasterWindow used;
  for (const auto& [name, value] : {std::pair{"column", &used.column},
                                    {"row", &used.row},
                                    {"columns", &used.columns},
                                    {"rows", &used.rows}})
    *value = in.number<uint32_t>(in.root(), name);
  if (shape[0] == 0 || used.rows == 0 || used.columns == 0 || std::max(used.rows, used.columns) > kMostPixels)
    throw InputError(fmt::format("{}: there is no picture in {} frames of {} x {} pixels", path, shape[0],
                                 used.columns, used.rows));
  in.same_length(shape[0] == step.size(), "the frames");
  for (const char* name : {"thickness", "strain", "speed", "broken"})
    in.check_stored(in.root(), name, {shape[0], used.rows, used.columns});
  grid = part_of(grid, used);
  const auto field = [&](const char* name, std::vector<float> Raster::*values) {
    for (size_t k = 0; k < step.size(); ++k)
      rasters.frames[k].*values =
          in.block<float>(in.root(), name, {k, used.row, used.column}, {1, used.rows, used.columns});
  };
  field("thickness", &Raster::thickness);
  field("strain", &Raster::strain);
  field("speed", &Raster::speed);
  field("broken", &Raster::broken);
  in.same_length(time.size() == step.size() && outside.size() == step.size(), "the frames");
  for (size_t k = 0; k < step.size(); ++k) {
    rasters.frames[k].step = step[k];
    rasters.frames[k].time = time[k];
    rasters.frames[k].outside = outside[k];
  }
  return rasters;
}

}  // namespace cuboct
