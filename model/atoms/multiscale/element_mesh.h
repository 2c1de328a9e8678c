// SPDX-License-Identifier: MIT
// Meshes of tetrahedra, the macro-elements of a body whose matter is a sample of atoms each.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/base/vec.h"

namespace cuboct {

// Along an axis that repeats no vertex stands twice: a corner is a vertex, moved by whole periods.
struct ElementMesh {
  struct Corner {
    uint32_t vertex = 0;
    std::array<int8_t, 3> image{};  // periods to add
  };
  std::vector<Vec3> x;                          // m, vertices
  std::vector<std::array<Corner, 4>> elements;  // of positive volume: 1, 2, 3 turn right-handed seen from 0
  std::vector<uint32_t> grain;                  // of each element, from 0
  Vec3 period = Vec3::Zero();                   // m; 0: the axis does not repeat

  uint32_t grains() const;
};

// m, where a corner stands while the vertices are at `x` and the body repeats after `period`.
Vec3 corner_place(const ElementMesh::Corner& corner, const std::vector<Vec3>& x, const Vec3& period);

// m^3, of the tetrahedron 0, a, b, c.
double signed_volume(const Vec3& a, const Vec3& b, const Vec3& c);
double element_volume(const ElementMesh& mesh, size_t element);

// Lines of a file, from 1, where each of its vertices and elements stands.
struct MeshLines {
  std::vector<int> vertices, elements;
};

// InputError for an element that is inverted or flat, a vertex that no element has, a corner that is not
// there. Elements and vertices count from 1, as in files of meshes. `name` of the mesh begins the message.
void check_mesh(const ElementMesh& mesh, const std::string& name, const MeshLines& lines = {});

// A box from 0 to `size` (m) of cubes, six tetrahedra each: H. W. Kuhn's division along a diagonal of the
// cube, which is mirrored in every second cube of each axis. So neighbours share their faces, and no
// direction of space is that of all diagonals. Along an axis that repeats the number of cubes must be even. A
// grain is a block of `grain_cubes`^3 cubes; 0: each element is a grain of its own.
ElementMesh box_mesh(const std::array<int, 3>& cubes, const Vec3& size, const std::array<bool, 3>& repeats,
                     int grain_cubes);

}  // namespace cuboct
