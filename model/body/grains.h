// SPDX-License-Identifier: MIT
// Packings of many grains: each is an FCC crystal, turned at random, in a Voronoi cell of a random centre.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/base/mat3.h"
#include "model/body/packing.h"

namespace cuboct {

struct Grains {
  double size = 0;    // m, mean distance of centres: the root of the volume, or of columns the area, of each
  uint64_t seed = 0;  // of centres and turns
  int column_axis = -1;   // grains are columns along this axis and turn about it alone; -1: they turn any way
  double closest = 0.65;  // pitches: of sites of two grains that are nearer to each other, one is left out
};

// Where grains may be: the bounds of the body. Along an axis that repeats, the period.
struct GrainDomain {
  Vec3 low = Vec3::Zero(), extent = Vec3::Zero();  // m
  std::array<bool, 3> repeats{};

  // m, the shortest from a to b, over images.
  Vec3 between(const Vec3& a, const Vec3& b) const;
};
GrainDomain grain_domain(const Shape* shape, const Periodic& box, const std::array<bool, 3>& repeats);

struct Grain {
  Vec3 centre = Vec3::Zero();  // m; 0 along the axis of columns
  Mat3 turn = Mat3::Identity();
};

// How many grains there are: the product of the domain's extents over the size, each at least 1. The axis of
// columns does not count.
double grain_count(const Grains& grains, const GrainDomain& domain);

// Uniformly random centres, each at least half a size from those before it (across faces that repeat too),
// and uniformly random turns. std::mt19937_64; of its numbers only sums, products, quotients and square roots
// are taken, which are the same on every machine.
std::vector<Grain> draw_grains(const Grains& grains, const GrainDomain& domain);

// The sites of all grains that lie in `shape` and `box`, as of pack(); `repeats` marks the axes of `box` that
// repeat. A site belongs to the grain whose centre, or an image of it, is nearest. A grain's crystal is
// turn * fcc.orientation, with a site at its centre + fcc.offset; its images along axes that repeat carry
// the crystal with them, so that the whole repeats whatever the crystal's own periods are. Along the axis of
// columns the crystal itself must repeat.
//
// Of sites that are nearer than `closest` those are kept first that have fewest such neighbours, then those
// with the lower id: each stays unless one that stays is too near. Ids count the grains; in each the images
// in ascending order, in each image the sites ascending in (l, k, h).
std::vector<Vec3> pack_grains(const Fcc& fcc, const Grains& grains, const Shape* shape, const Periodic& box,
                              const std::array<bool, 3>& repeats);

}  // namespace cuboct
