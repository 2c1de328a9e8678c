// SPDX-License-Identifier: MIT
// Frames as pictures need them: what millions of particles show, averaged along a line of sight, in a file of a
// megabyte or so per frame.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/frames.h"

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

// A particle of radius r (FrameStyle) is drawn as a square of edge 2r with the volume (2r)^3/sqrt(2) that it has in the
// packing, spread over the pixels in proportion to what of the square they hold: so thickness is right however
// pixels and packing lie, and sums to the volume of all particles.
constexpr double particle_thickness(double edge) { return edge / 1.4142135623730951; }

// For frames of one body: right is the longest axis of the first, up the next (the lower where equal). `across` pixels
// span the first frame's longest axis, or fewer, so that no pixel is below a quarter of a particle. The grid holds
// all frames' particles, but for those farther than half that longest axis from the first frame's box: one that flew off
// does not make the picture small. InputError where there are no particles.
RasterGrid raster_grid(const std::vector<Frame>& frames, double radius, uint32_t across);

Raster rasterise(const Frame& frame, const RasterGrid& grid, double radius);

// HDF5; layout in docs/reference/trace.md. Values are rounded to 11 significant bits, so that they pack well. Same
// rasters, same bytes; never half a file.
void write_rasters(const std::string& path, const Rasters& rasters);
Rasters read_rasters(const std::string& path);

}  // namespace cuboct
