// SPDX-License-Identifier: MIT
// Frames as pictures need them: what millions of particles show, averaged along a line of sight, in a file of
// a megabyte or so per frame.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/trace/frame.h"

namespace cuboct {

// Seen along an axis of the scene: right and up are axes too, pixels are squares, rows from the bottom.
struct RasterGrid {
  int right = 0, up = 1;
  double left = 0, bottom = 0;  // m, of the lower left pixel's lower left corner
  double pixel = 1;             // m
  uint32_t columns = 0, rows = 0;

  size_t pixels() const { return size_t{columns} * rows; }
};

// [row * columns + column].
struct Raster {
  uint64_t step = 0;
  double time = 0;               // s
  std::vector<float> thickness;  // m, of the material that the pixel looks through
  // Means over that material; 0 where there is none.
  std::vector<float> strain;  // 1, axial elongation as in Frame
  std::vector<float> speed;   // m/s
  std::vector<float> broken;  // broken bonds per particle, as in Frame
  uint64_t outside = 0;       // particles that the grid does not hold
};

// What a run leaves of its frames.
struct Rasters {
  std::string title;
  int strain_axis = 0;
  double particle = 0;  // m, edge of the square that stands for a particle
  RasterGrid grid;
  std::vector<Raster> frames;
};

// A particle of radius r (FrameStyle) is drawn as a square of edge 2r with the volume (2r)^3/sqrt(2) that it
// has in the packing, spread over the pixels in proportion to what of the square they hold: so thickness is
// right however pixels and packing lie, and sums to the volume of all particles.
constexpr double particle_thickness(double edge) { return edge / 1.4142135623730951; }

// For frames of one body that begins as `first`: right is its longest axis, up the next (the lower where
// equal). `across` pixels span the longest axis, or fewer, so that no pixel is below a quarter of a particle.
// The grid reaches half that axis beyond the body on all sides: one particle that flew off does not make the
// picture small. InputError where there are no particles.
RasterGrid raster_grid(const Frame& first, double radius, uint32_t across);

// Pixels column ... column + columns - 1 of rows row ... row + rows - 1 of a grid.
struct RasterWindow {
  uint32_t column = 0, row = 0, columns = 0, rows = 0;
};
// What the frame's particles touch.
RasterWindow window_of(const Frame& frame, const RasterGrid& grid, double radius);
RasterWindow join(const RasterWindow& a, const RasterWindow& b);  // the smallest that holds both
RasterGrid part_of(const RasterGrid& grid, const RasterWindow& window);

Raster rasterise(const Frame& frame, const RasterGrid& grid, double radius);

// HDF5; layout in docs/reference/trace.md. Frames go to the file as they come. Values are rounded to 11
// significant bits, so that they pack well. Same rasters, same bytes.
class RasterWriter {
 public:
  // Writes to `temporary`; finish() renames it to `path`. `head` has no frames and no grid: the first frame,
  // which may not be empty, lays it out for `across` pixels along the body.
  RasterWriter(const std::string& path, const std::string& temporary, const Rasters& head, uint32_t across);
  ~RasterWriter();  // removes the temporary file where finish() was not reached
  RasterWriter(const RasterWriter&) = delete;
  RasterWriter& operator=(const RasterWriter&) = delete;

  // Throws InputError where the disk has no room: the frame is then left out, and the next one may fit.
  void add(const Frame& frame);
  void finish();  // of one frame or more
  void leave();   // leaves the temporary file as it is

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Of the grid what the frames touch.
Rasters read_rasters(const std::string& path);

}  // namespace cuboct
