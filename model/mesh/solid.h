// SPDX-License-Identifier: MIT
// The solid within a surface of triangles.
#pragma once

#include "model/mesh/surface.h"

namespace cuboct {

// As read_mesh() says of shapes; fills in `doubt`. `facts`: of this surface.
ShapePtr solid_within(Surface surface, MeshFacts& facts);

}  // namespace cuboct
