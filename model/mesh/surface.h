// SPDX-License-Identifier: MIT
// A surface of triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/base/vec.h"
#include "model/scene/mesh.h"

namespace cuboct {

struct Surface {
  std::vector<Vec3> points;  // m
  std::vector<std::array<uint32_t, 3>> triangles;

  Vec3 corner(size_t triangle, int k) const { return points[triangles[triangle][k]]; }
};

// Makes points that are equal one point, and leaves triangles without area out; returns how many those were.
size_t join_points(Surface& surface);

// Edges, area and volume into `facts`; needs a surface whose points are joined.
void look_at(const Surface& surface, MeshFacts& facts);

// The point of a triangle that is nearest to x. C. Ericson, "Real-Time Collision Detection" (2005), 5.1.5.
Vec3 nearest_point(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace cuboct
