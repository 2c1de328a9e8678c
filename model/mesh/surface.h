// SPDX-License-Identifier: MIT
// A surface of triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/base/vec.h"
#include "model/body/mesh.h"

namespace cuboct {

struct Surface {
  std::vector<Vec3> points;  // m
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> shells;  // of each triangle, by orient()

  Vec3 corner(size_t triangle, int k) const { return points[triangles[triangle][k]]; }
};

// Makes points that are equal one point, and leaves triangles without area out; returns how many those were.
size_t join_points(Surface& surface);

// Half the product of two sides: the area, along the normal.
Vec3 area_vector(const Surface& surface, size_t triangle);

// An edge of a triangle, from its lesser to its greater point; `along`: whether the triangle goes that way.
struct Edge {
  uint32_t low, high, triangle;
  bool along;
  bool joins(const Edge& other) const { return low == other.low && high == other.high; }
};
// Of all triangles; those that join stand together.
std::vector<Edge> edges_of(const Surface& surface);

// Triangles that meet in edges of two make up a shell, and are turned one way: that of most of its area.
// Needs a surface whose points are joined. Returns the number of edges that triangles met turned against each
// other.
size_t orient(Surface& surface);

// Edges and area into `facts`; needs a surface that is oriented.
void look_at(const Surface& surface, MeshFacts& facts);

// The volume within each shell, m^3, by the divergence theorem: negative of one whose normals point inwards.
std::vector<double> volumes_of(const Surface& surface);

// The point of a triangle that is nearest to x. C. Ericson, "Real-Time Collision Detection" (2005), 5.1.5.
Vec3 nearest_point(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace cuboct
