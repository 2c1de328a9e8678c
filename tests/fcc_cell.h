// SPDX-License-Identifier: MIT
// The primitive cell of an FCC packing for tests, off the origin.
#pragma once

#include <numbers>

#include "model/solid/crystal_cell.h"

namespace cuboct::test {

inline CrystalCell primitive_fcc(double pitch) {
  CrystalCell cell;
  cell.vectors << 0, 1, 1, 1, 0, 1, 1, 1, 0;
  cell.vectors *= pitch / std::numbers::sqrt2;
  cell.x = {Vec3(0.3, -0.1, 0.2)};
  cell.type = {0};
  return cell;
}

}  // namespace cuboct::test
