// SPDX-License-Identifier: MIT
// Face-centred cubic packings of particles, and random velocities.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "model/base/mat3.h"
#include "model/body/geometry.h"
#include "model/contract/rule.h"

namespace cuboct {

// The infinite lattice of sites: offset + orientation * (a/2) * (h, k, l) with h + k + l even and a = sqrt(2)
// * pitch.
struct Fcc {
  double pitch = 0;                     // m, nearest-neighbour distance
  Mat3 orientation = Mat3::Identity();  // columns: cubic axes in scene coordinates
  Vec3 offset = Vec3::Zero();           // m, one site

  double cell() const;  // m, edge a of the conventional cubic cell
};

// kg per particle: one particle per pitch^3/sqrt(2).
double particle_mass(double density, double pitch);

// The sites in `shape` (surface included, with a tolerance of 1e-6 of the pitch, so that rounding cannot drop
// a face of sites), ascending in (l, k, h). Along axes on which `box` has an extent, sites stand in [origin,
// origin + extent), and `shape` may be null if all three have one. The bounds of what is packed must be
// finite, and few enough for numbers of 64 bits.
std::vector<Vec3> pack(const Fcc& fcc, const Shape* shape, const Periodic& box);

// What packing would take, told before it starts.
struct PackingSize {
  double farthest = 0;  // corner of the bounds from site 0, in half cells of the crystal
  double tested = 0;    // sites, each held against the shape, and rows of sites
  double sites =
      0;  // of them inside: a sample of the bounds tells, to a few percent in a body of many pitches
};
PackingSize packing_size(const Fcc& fcc, const Shape* shape, const Periodic& box);

// Whether moving by `shift` maps the sites on themselves (within 1e-6 of the pitch).
bool is_period(const Fcc& fcc, const Vec3& shift);

struct ThermalShare {
  double mass = 1, speed = 1;  // a particle's factors on a mass and on `speed`
};
// Adds to v independent normal deviates of standard deviation `speed` (m/s) per component, less the velocity
// of their centre of mass, to the particles `ids` in their order. std::mt19937_64 and the Box-Muller
// transform, as std::normal_distribution differs between libraries.
void add_thermal(
    std::vector<Vec3>& v, const std::vector<uint32_t>& ids, double speed, uint64_t seed,
    const std::function<ThermalShare(uint32_t id)>& share = [](uint32_t) { return ThermalShare{}; });

}  // namespace cuboct
