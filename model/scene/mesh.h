// SPDX-License-Identifier: MIT
// Solids whose surface is a mesh of triangles, from a CAD program's file (STL, OBJ, PLY and what else Assimp
// reads). What reads and searches meshes is a module of its own beside the program, loaded when a scene first
// asks for one.
#pragma once

#include <cstddef>
#include <string>

#include "model/scene/geometry.h"

namespace cuboct {

// What a mesh is like, apart from its shape. An edge of a closed surface borders two triangles, which go
// along it in opposite senses.
struct MeshFacts {
  std::string file;
  size_t triangles = 0;
  size_t flat = 0;     // triangles without area, which were left out
  size_t open = 0;     // edges of one triangle
  size_t crowded = 0;  // edges of more than two
  size_t turned = 0;   // edges whose two triangles go along them in the same sense
  double area = 0;     // m^2
  double volume = 0;   // m^3, by the divergence theorem; of a surface that is not closed it means little
  // Of points inside, the share for which some of eleven rays tell otherwise: what the leaks amount to.
  double doubt = 0;

  bool closed() const { return open == 0 && crowded == 0; }
};

// What a user should know of a mesh that is not quite closed; empty of one that is.
std::string mesh_warning(const MeshFacts& facts);

struct Mesh {
  ShapePtr shape;
  MeshFacts facts;
};

// The solid in `file`, whose unit of length is `unit` metres. A point is inside where most rays from it cross
// the surface an odd number of times; distances to triangles are in doubles. Sites nearer to the surface than
// coordinates in floats tell apart (2^-22 of the largest) count as on it. Throws InputError without a place.
Mesh read_mesh(const std::string& file, double unit);

// What the module offers (model/mesh); it says what is wrong in `error`.
using ReadMesh = void(const std::string& file, double unit, Mesh& mesh, std::string& error);
inline constexpr const char* kMeshModule = "cuboct-mesh.so";
inline constexpr const char* kReadMesh = "cuboct_read_mesh";

}  // namespace cuboct
