// SPDX-License-Identifier: MIT
// What a packed body owes to where its sites happen to fall. A face of a shape stands between two layers of
// sites, so a move of the packing takes a layer off or adds one: a section of few layers changes by one of
// them, its bending stiffness by the cube.
#pragma once

#include <array>
#include <optional>

#include "model/body/packing.h"

namespace cuboct {

// What is packed: sites of one crystal in a shape, or in a box.
struct PackedShape {
  Fcc fcc;
  // Crystal directions along x, y and z in least integers; none where they are not such.
  std::array<std::optional<Vec3>, 3> along;
  ShapePtr shape;  // null: the whole box
  Periodic box;    // bounds, as pack() takes them
  // Axes along which the packing may move: none that repeat, none with a single layer.
  std::array<bool, 3> free{true, true, true};
  bool halves = false;  // particles in planes of symmetry stand for half of one: no section is told
};

// m, between layers of sites across a crystal direction of least integers: a/2 over its length, twice that
// where all three are odd, as h + k + l of a site is even.
double layer_spacing(const Fcc& fcc, const Vec3& direction);

// A section across an axis, by the particles near it. A particle counts for its share of volume over the
// length looked at. Shares are of the mean over places of the packing, which is that of the shape itself.
struct PackedSection {
  int axis = 0;
  double at = 0;    // m, along it
  double mean = 0;  // m^2
  // area, and the second moment of area (about the section's centre; of the free axes the one that changes
  // more), as packed, least and most
  struct Share {
    double packed = 1, least = 1, most = 1;
    double range() const { return most - least; }
  };
  Share area{}, bending{};
};

// The thinnest of several inner sections across each axis that a move of the packing changes by a hundredth.
// None in a box that repeats, with planes of symmetry, with very many layers, or with a whole number of them.
// None across an axis along which the crystal is turned, or the body has less than two layers. Looks at 10^7
// sites at most, of meshes of many triangles at fewer: at fewer sections then, and none where one is too
// many.
std::optional<PackedSection> packed_section(const PackedShape& packed);

}  // namespace cuboct
