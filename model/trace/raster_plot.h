// SPDX-License-Identifier: MIT
// Figures of rasters by gnuplot: frames beside and under one another, to one scale, with axes and a colour
// bar.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "model/trace/raster.h"

namespace cuboct {

enum class Field : uint8_t { strain, speed, thickness, broken };
// By its name; InputError with the nearest spelling.
Field field_of(const std::string& name);

struct RasterPicture {
  Field field = Field::strain;
  std::vector<size_t> frames;  // indices into Rasters::frames, in the order of drawing
  double limit = 0;            // of the colours, 1, m/s, m or bonds; 0: usual_limit
  int width = 1600;            // pixels
};

// PNG bytes. Strain is drawn from -limit (blue) to limit (red), the others from 0. A pixel that looks through
// less than a fifth of a particle's thickness stays white.
std::string plot_rasters(const Rasters& rasters, const RasterPicture& picture);

// The 90th percentile of a field's magnitude, over the drawn pixels of all frames: 1, m/s or m; of broken
// bonds over the pixels that have some.
double usual_limit(const Rasters& rasters, Field field);
// Of sizes, wherever they are from; 0 without any.
double usual_limit(std::vector<float> sizes);

// Up to four, evenly spread, first and last included.
std::vector<size_t> spread_frames(size_t count);

}  // namespace cuboct
