// SPDX-License-Identifier: MIT
#include "model/trace/raster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

#include "model/base/error.h"
#include "model/body/geometry.h"
#include "model/body/packing.h"
#include "tests/support/folder.h"
#include "tests/support/refused_with.h"

namespace cuboct {
namespace {

namespace fs = std::filesystem;

Frame frame_of(std::vector<Vec3> x) {
  Frame frame;
  frame.v.assign(x.size(), Vec3(0, 3, 4));
  frame.strain.assign(x.size(), 0.25);
  frame.type.assign(x.size(), 0);
  frame.broken.assign(x.size(), 3);
  frame.x = std::move(x);
  return frame;
}

// What the frames touch of the first one's grid.
RasterGrid grid_of(const std::vector<Frame>& frames, double radius, uint32_t across) {
  const RasterGrid grid = raster_grid(frames[0], radius, across);
  RasterWindow used;
  for (const Frame& frame : frames) used = join(used, window_of(frame, grid, radius));
  return part_of(grid, used);
}

// Four pixels of edge 1, one particle of edge 1 whose middle lies a quarter right of and above the middle: it
// has 1/4 * 1/4, 3/4 * 1/4, ... of its square in them, and the thickness 1/sqrt(2).
TEST(Raster, AParticleIsSpreadByArea) {
  const RasterGrid grid{.right = 0, .up = 1, .left = 0, .bottom = 0, .pixel = 1, .columns = 2, .rows = 2};
  const Raster raster = rasterise(frame_of({{1.25, 1.25, 7}}), grid, 0.5);
  const double t = 1 / std::sqrt(2.0);
  const double expected[4] = {t / 16, 3 * t / 16, 3 * t / 16, 9 * t / 16};
  for (int k = 0; k < 4; ++k) {
    EXPECT_FLOAT_EQ(raster.thickness[k], static_cast<float>(expected[k])) << k;
    EXPECT_FLOAT_EQ(raster.strain[k], 0.25f);
    EXPECT_FLOAT_EQ(raster.speed[k], 5);
    EXPECT_FLOAT_EQ(raster.broken[k], 3);
  }
  EXPECT_EQ(raster.outside, 0u);
}

// Two particles in one pixel: 3/4 of one's square, a quarter of the other's.
TEST(Raster, AMeanIsWeighedByArea) {
  const RasterGrid grid{.right = 0, .up = 1, .left = 0, .bottom = 0, .pixel = 1, .columns = 3, .rows = 1};
  Frame frame = frame_of({{0.75, 0.5, 0}, {2.25, 0.5, 0}});
  frame.strain = {1, -1};
  frame.broken = {0, 4};
  const Raster raster = rasterise(frame, grid, 0.5);
  EXPECT_FLOAT_EQ(raster.strain[0], 1);
  EXPECT_NEAR(raster.strain[1], 0, 1e-6);
  EXPECT_FLOAT_EQ(raster.broken[1], 2);
  frame.x[1][0] = 2.0;  // now half of its square
  EXPECT_FLOAT_EQ(rasterise(frame, grid, 0.5).strain[1], static_cast<float>((0.25 - 0.5) / 0.75));
}

// A plate of 20 x 40 x 3 cubic cells with pixels that do not fit the packing: inside, away from the edges,
// each pixel looks through as much as any other to within what a few planes leave uneven, and all hold the
// whole volume.
TEST(Raster, ThicknessIsThatOfThePlate) {
  const Fcc fcc{.pitch = 1};
  const auto plate = box(Vec3::Zero(), Vec3(40, 80, 6) * fcc.cell() / 2);
  const auto x = pack(fcc, plate.get(), {});
  const RasterGrid grid = grid_of({frame_of(x)}, 0.5, 37);
  EXPECT_EQ(grid.right, 1);
  EXPECT_EQ(grid.up, 0);
  EXPECT_EQ(grid.columns, 37u);
  const Raster raster = rasterise(frame_of(x), grid, 0.5);
  const double volume =
      std::accumulate(raster.thickness.begin(), raster.thickness.end(), 0.0) * grid.pixel * grid.pixel;
  EXPECT_NEAR(volume, static_cast<double>(x.size()) / std::sqrt(2.0), 1e-3 * volume);
  // Seven planes half a cell apart.
  const double thick = 7 * fcc.cell() / 2;
  for (uint32_t row = 2; row + 2 < grid.rows; ++row)
    for (uint32_t column = 2; column + 2 < grid.columns; ++column)
      EXPECT_NEAR(raster.thickness[row * grid.columns + column], thick, 0.1 * thick);
}

TEST(Raster, PixelsAreNoFinerThanAQuarterOfAParticle) {
  EXPECT_DOUBLE_EQ(raster_grid(frame_of({{0, 0, 0}, {9, 0, 0}}), 0.5, 1000).pixel, 0.25);
  EXPECT_THROW(raster_grid(Frame{}, 0.5, 100), InputError);
}

// A particle that flies off may widen the picture by half the body's length on each side; beyond, it is
// counted.
TEST(Raster, OneThatFliesOffIsLeftOut) {
  const Frame first = frame_of({{0, 0, 0}, {9, 4, 0}});
  for (const auto& [to, outside] : {std::pair{13.5, 0u}, {14.5, 1u}, {1e30, 1u}, {NAN, 1u}}) {
    const Frame later = frame_of({{0, 0, 0}, {to, 4, 0}});
    const RasterGrid grid = grid_of({first, later}, 0.5, 20);
    EXPECT_LE(grid.columns, 31u) << to;
    EXPECT_EQ(rasterise(first, grid, 0.5).outside, 0u) << to;
    EXPECT_EQ(rasterise(later, grid, 0.5).outside, outside) << to;
  }
}

TEST(Raster, AFileHoldsElevenBits) {
  const test::Folder folder;
  const fs::path& directory = folder.path();
  std::vector<Vec3> x;
  for (int k = 0; k < 50; ++k) x.emplace_back(0.37 * k, std::sin(k), 0);
  Frame frame = frame_of(x);
  for (size_t k = 0; k < x.size(); ++k) frame.strain[k] = std::cos(static_cast<double>(k)) / 3;
  frame.step = 70;
  frame.time = 1e-6;
  Rasters rasters{"it's a title", 2, 1, grid_of({frame}, 0.5, 100), {}};
  rasters.frames = {rasterise(frame, rasters.grid, 0.5), rasterise(frame_of(x), rasters.grid, 0.5)};
  const std::string a = directory / "a.h5", b = directory / "b.h5";
  for (const std::string& path : {a, b}) {
    RasterWriter out(path, path + ".part", {rasters.title, rasters.strain_axis, rasters.particle, {}, {}},
                     100);
    out.add(frame);
    out.add(frame_of(x));
    EXPECT_FALSE(fs::exists(path));
    out.finish();
  }
  const auto bytes = [](const std::string& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  };
  EXPECT_EQ(bytes(a), bytes(b));
  const Rasters again = read_rasters(a);
  EXPECT_EQ(again.title, rasters.title);
  EXPECT_EQ(again.strain_axis, 2);
  EXPECT_EQ(again.particle, 1);
  EXPECT_EQ(again.grid.columns, rasters.grid.columns);
  EXPECT_EQ(again.grid.rows, rasters.grid.rows);
  EXPECT_EQ(again.grid.pixel, rasters.grid.pixel);
  ASSERT_EQ(again.frames.size(), 2u);
  EXPECT_EQ(again.frames[0].step, 70u);
  EXPECT_EQ(again.frames[0].time, 1e-6);
  bool rounded = false;
  for (size_t k = 0; k < rasters.grid.pixels(); ++k) {
    const float was = rasters.frames[0].strain[k], is = again.frames[0].strain[k];
    EXPECT_LE(std::abs(is - was), std::ldexp(std::abs(was), -11)) << k;
    rounded = rounded || is != was;
    EXPECT_LE(std::abs(again.frames[1].speed[k] - rasters.frames[1].speed[k]), 5 * 0x1p-11);
    EXPECT_LE(std::abs(again.frames[1].broken[k] - rasters.frames[1].broken[k]), 3 * 0x1p-11);
  }
  EXPECT_TRUE(rounded);
  EXPECT_EQ(refused_with([&] { read_rasters(CUBOCT_SOURCE_DIR "/LICENSE"); }),
            CUBOCT_SOURCE_DIR "/LICENSE is not an HDF5 file");
}

}  // namespace
}  // namespace cuboct
