// SPDX-License-Identifier: MIT
#include "model/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "model/hdf5_file.h"
#include "model/output.h"

namespace cuboct {
namespace {

constexpr char kFormat[] = "cuboct rasters";
constexpr uint32_t kVersion = 1;
// Along an axis, of what is read; twice what a run writes of its longest, whose ends may fly apart.
constexpr hsize_t kMostPixels = 1 << 16;

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

RasterGrid raster_grid(const std::vector<Frame>& frames, double radius, uint32_t across) {
  if (frames.empty() || frames[0].x.empty()) throw InputError("a picture needs particles");
  Extent first, all;
  for (const Vec3& x : frames[0].x) first.add(x);
  const Vec3 extent = first.upper - first.lower;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return extent[a] > extent[b]; });
  RasterGrid grid;
  grid.right = order[0];
  grid.up = order[1];
  const double longest = extent[grid.right] + 2 * radius;
  grid.pixel = std::max(longest / across, radius / 2);
  const Vec3 way = Vec3::Constant(longest / 2);
  for (const Frame& frame : frames)
    for (const Vec3& x : frame.x)
      if (x.allFinite()) all.add(x.cwiseMax(first.lower - way).cwiseMin(first.upper + way));
  grid.left = all.lower[grid.right] - radius;
  grid.bottom = all.lower[grid.up] - radius;
  const auto pixels = [&](int axis) {
    const double wide = (all.upper[axis] - all.lower[axis] + 2 * radius) / grid.pixel;
    return static_cast<uint32_t>(std::ceil(wide * (1 - 1e-12)));
  };
  grid.columns = pixels(grid.right);
  grid.rows = pixels(grid.up);
  return grid;
}

Raster rasterise(const Frame& frame, const RasterGrid& grid, double radius) {
  std::vector<double> thickness(grid.pixels(), 0), strain = thickness, speed = thickness;
  Raster raster{frame.step, frame.time, {}, {}, {}, 0};
  const double side = 2 * radius / grid.pixel;  // pixels
  // Of the volume side^2 * particle_thickness, what a whole pixel holds.
  const double full = particle_thickness(2 * radius);
  for (size_t i = 0; i < frame.x.size(); ++i) {
    const double x = (frame.x[i][grid.right] - grid.left) / grid.pixel - side / 2;
    const double y = (frame.x[i][grid.up] - grid.bottom) / grid.pixel - side / 2;
    // Particles at the grid's edge touch it to within rounding.
    if (!(x >= -1e-6 && y >= -1e-6 && x + side <= grid.columns + 1e-6 && y + side <= grid.rows + 1e-6)) {
      ++raster.outside;
      continue;
    }
    const double v = frame.v[i].norm();
    const auto first = [](double at) { return static_cast<uint32_t>(std::max(0.0, std::floor(at))); };
    const auto last = [&](double at, uint32_t count) { return std::min(count, first(at + side) + 1); };
    const auto share = [&](uint32_t pixel, double at) {
      return std::max(0.0, std::min(pixel + 1.0, at + side) - std::max(static_cast<double>(pixel), at));
    };
    for (uint32_t row = first(y); row < last(y, grid.rows); ++row)
      for (uint32_t column = first(x); column < last(x, grid.columns); ++column) {
        const size_t at = size_t{row} * grid.columns + column;
        const double part = share(row, y) * share(column, x) * full;
        thickness[at] += part;
        strain[at] += part * frame.strain[i];
        speed[at] += part * v;
      }
  }
  raster.thickness.reserve(grid.pixels());
  raster.strain.reserve(grid.pixels());
  raster.speed.reserve(grid.pixels());
  for (size_t at = 0; at < grid.pixels(); ++at) {
    const double over = thickness[at] > 0 ? 1 / thickness[at] : 0;
    raster.thickness.push_back(static_cast<float>(thickness[at]));
    raster.strain.push_back(static_cast<float>(strain[at] * over));
    raster.speed.push_back(static_cast<float>(speed[at] * over));
  }
  return raster;
}

void write_rasters(const std::string& path, const Rasters& rasters) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  check_writable(path);
  write_whole(path, [&](const std::string& temporary) {
    hdf5::Writer out(temporary, path);
    const RasterGrid& grid = rasters.grid;
    out.text(out.root(), "format", kFormat);
    out.number<uint32_t>(out.root(), "version", kVersion);
    out.text(out.root(), "title", rasters.title);
    out.number<uint32_t>(out.root(), "strain_axis", static_cast<uint32_t>(rasters.strain_axis));
    out.number<uint32_t>(out.root(), "right", static_cast<uint32_t>(grid.right));
    out.number<uint32_t>(out.root(), "up", static_cast<uint32_t>(grid.up));
    for (const auto& [name, value] : {std::pair{"left", grid.left}, {"bottom", grid.bottom},
                                      {"pixel", grid.pixel}, {"particle", rasters.particle}})
      out.number<double>(out.root(), name, value);
    std::vector<uint64_t> step, outside;
    std::vector<double> time;
    for (const Raster& frame : rasters.frames) {
      step.push_back(frame.step);
      time.push_back(frame.time);
      outside.push_back(frame.outside);
    }
    const hsize_t count = rasters.frames.size();
    out.array(out.root(), "step", {count}, step, "", "[frame]");
    out.array(out.root(), "time", {count}, time, "s", "[frame]");
    out.array(out.root(), "outside", {count}, outside, "particles", "[frame]");
    const auto field = [&](const char* name, std::vector<float> Raster::*values, const char* unit) {
      std::vector<float> all;
      for (const Raster& frame : rasters.frames)
        for (const float value : frame.*values) all.push_back(rounded(value));
      out.array(out.root(), name, {count, grid.rows, grid.columns}, all, unit, "[frame][row][column]");
    };
    field("thickness", &Raster::thickness, "m");
    field("strain", &Raster::strain, "1");
    field("speed", &Raster::speed, "m/s");
    out.close();
  });
}

Rasters read_rasters(const std::string& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hdf5::Reader in(path, "rasters file");
  if (!in.has_attribute(in.root(), "format") || in.text(in.root(), "format") != kFormat)
    throw InputError(fmt::format("{} holds no rasters", path), "'cuboct run SCENE --out DIR' makes DIR/rasters.h5");
  if (const auto version = in.number<uint32_t>(in.root(), "version"); version != kVersion)
    throw InputError(fmt::format("{} has version {} of the format, this cuboct reads {}", path, version, kVersion));
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
  const hdf5::Shape shape = in.shape(in.root(), "thickness");
  if (shape.size() != 3) throw InputError(fmt::format("{}: 'thickness' has no rows and columns", path));
  if (shape[0] == 0 || shape[1] == 0 || shape[2] == 0 || std::max(shape[1], shape[2]) > kMostPixels)
    throw InputError(fmt::format("{}: there is no picture in {} frames of {} x {} pixels", path, shape[0],
                                 shape[2], shape[1]));
  grid.rows = static_cast<uint32_t>(shape[1]);
  grid.columns = static_cast<uint32_t>(shape[2]);
  const auto field = [&](const char* name, std::vector<float> Raster::*values) {
    const auto all = in.array<float>(in.root(), name, {grid.rows, grid.columns});
    in.same_length(all.size() == step.size() * grid.pixels(), "the fields");
    for (size_t k = 0; k < step.size(); ++k)
      (rasters.frames[k].*values).assign(all.begin() + static_cast<ptrdiff_t>(k * grid.pixels()),
                                         all.begin() + static_cast<ptrdiff_t>((k + 1) * grid.pixels()));
  };
  field("thickness", &Raster::thickness);
  field("strain", &Raster::strain);
  field("speed", &Raster::speed);
  in.same_length(time.size() == step.size() && outside.size() == step.size(), "the frames");
  for (size_t k = 0; k < step.size(); ++k) {
    rasters.frames[k].step = step[k];
    rasters.frames[k].time = time[k];
    rasters.frames[k].outside = outside[k];
  }
  return rasters;
}

}  // namespace cuboct
