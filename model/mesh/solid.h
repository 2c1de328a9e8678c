// SPDX-License-Identifier: MIT
// The solid within a surface of triangles.
#pragma once

#include "model/mesh/surface.h"

namespace cuboct {

// As read_mesh() says of shapes; fills in what rays and shells tell. `facts`: of this surface, which is
// oriented.
ShapePtr solid_within(Surface surface, MeshFacts& facts);

}  // namespace cuboct
