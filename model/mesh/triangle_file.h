// SPDX-License-Identifier: MIT
// What the program that reads meshes leaves: this head, the points (three doubles each), the triangles (three
// indices each). In this machine's own words, as nothing but this build reads it.
#pragma once

#include <array>
#include <cstdint>

namespace cuboct {

struct TriangleFileHead {
  uint64_t points = 0, triangles = 0;
  double unit = 0;      // m: what the file says one of its units is; 0: nothing
  uint64_t up = 0;      // 'x', 'y' or 'z', as the file says; 0: nothing
  double rounding = 0;  // of coordinates, in the file's units: they come in floats
};

}  // namespace cuboct
