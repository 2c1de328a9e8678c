// SPDX-License-Identifier: MIT
// Tetrahedra from files of Gmsh, format MSH 2 or 4 as text (C. Geuzaine and J.-F. Remacle, Int. J. Numer.
// Meth. Eng. 79, 1309 (2009); the Gmsh manual, "File formats").
#pragma once

#include <array>
#include <string>

#include "model/atoms/multiscale/element_mesh.h"

namespace cuboct {

// `unit`: m, of the file's lengths. Volumes of the model (of MSH 2 the elementary entity) become grains, in
// ascending order of their tags. Elements of other kinds than tetrahedra of four nodes that have a volume are
// refused; points, lines and faces are passed over. Along an axis that repeats each vertex of the upper face
// must have one of the lower face across: they become one. InputError with line.
ElementMesh read_gmsh(const std::string& path, double unit, const std::array<bool, 3>& repeats);

}  // namespace cuboct
