// SPDX-License-Identifier: MIT
// Solids whose surface is a mesh of triangles, from a CAD program's file. A program beside ours reads the
// file; a module beside it, loaded when a scene first asks for a mesh, searches the triangles.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "model/body/geometry.h"

namespace cuboct {

// What a mesh is like, apart from its shape. An edge of a closed surface borders two triangles, or more of
// bodies that touch, half of which go along it and half back.
struct MeshFacts {
  std::string file;
  double unit = 0;         // m, of one of the file's
  double stated_unit = 0;  // m, as the file states; 0: it states none
  char up = 0;             // 'x', 'y' or 'z', which the file says is up; coordinates stay as they are in it
  double size = 0;         // m, the largest extent
  double rounding = 0;     // m: files are read in floats
  size_t triangles = 0;
  size_t flat = 0;       // triangles without area, which were left out
  size_t open = 0;       // edges of one triangle
  size_t crowded = 0;    // edges of more than two, of which too many go along
  size_t one_sided = 0;  // edges whose two triangles cannot be turned one way, as in a Moebius strip
  size_t turned = 0;  // edges whose two triangles were turned against each other, until they were turned back
  size_t inside_out = 0;  // bodies whose normals pointed inwards, where those of others pointed outwards
  double area = 0;        // m^2
  double volume = 0;      // m^3, of all bodies, by the divergence theorem; of an open surface it means little
  // Of points inside: the share within more than one body, and that for which some of eleven rays tell
  // otherwise, which is what leaks amount to.
  double overlap = 0, doubt = 0;

  // A thousand particles along the body are then less than fifty times coarser.
  bool too_coarse() const { return rounding > 2e-5 * size; }
  bool closed() const { return open == 0 && crowded == 0 && one_sided == 0; }
};

// "12 triangles, closed; ...": for people.
std::string mesh_text(const MeshFacts& facts);
// What a user should know of a mesh that leaks; empty of one whose rays agree.
std::string mesh_warning(const MeshFacts& facts);

struct Mesh {
  ShapePtr shape;
  MeshFacts facts;
};

// The solid in `file`, one of whose units of length is `unit` metres, or what the file states. Bodies that
// overlap are one: a point is inside where for most rays from it the surface winds about it. Distances to
// triangles are in doubles. Sites nearer to the surface than coordinates in floats tell apart (2^-22 of the
// largest) count as on it. Throws InputError without a place, also where the file cannot be read within
// reader_limits().
Mesh read_mesh(const std::string& file, std::optional<double> unit);

// What the module offers (model/mesh), of the file that the program left; it says what is wrong in `error`.
using ReadMesh = void(const std::string& triangles, std::optional<double> unit, Mesh& mesh,
                      std::string& error);
inline constexpr const char* kMeshModule = "cuboct-mesh.so";
inline constexpr const char* kReadMesh = "cuboct_read_mesh";
inline constexpr const char* kMeshReader = "cuboct-read-mesh";

}  // namespace cuboct
