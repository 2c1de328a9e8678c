// SPDX-License-Identifier: MIT
// [[symmetry]]: planes at which a body goes on as its mirror image, which is not computed.
//
// A particle in such a plane is half of one: the other half belongs to the image. So it has half of the mass,
// and half of each bond to another in the plane; it never leaves the plane. Bonds out of the plane stay
// whole, as the image has its own. A particle in two planes is a quarter. All accelerations are then those of
// the whole body, to the rounding of the arithmetic, while no particle off the plane comes within the
// cutoff of the image of another.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "model/config/config.h"
#include "model/scene/scene_parts.h"

namespace cuboct {

struct SymmetryPlane {
  int axis = 0;      // of the scene: the plane's normal
  double place = 0;  // m, along it
  ConfigValue key;   // for errors
};

// Throws InputError with the place.
std::vector<SymmetryPlane> read_symmetry(const ConfigTable& root, const PackingChoice* packing,
                                         const Scene& scene);

struct Divided {
  std::vector<uint8_t> planes;  // of each material: those in which its particles stand, a bit each
  Rule whole;                   // as if particles in planes were whole, for the same materials
};
// What of a particle that stands in so many planes belongs to the body that is computed.
double part_beside(unsigned planes);
// Divides materials into those off the planes and those in them: `material` (by particle), the names and the
// rule's strengths, laws, contacts and masses, by material, grow. Throws InputError where no particle stands
// in a plane, particles stand on both sides of one, or one stands so near that it would feel its image.
Divided divide(const std::vector<SymmetryPlane>& planes, const std::vector<Vec3>& x, double tolerance,
               std::vector<int>& material, std::vector<std::string>& names, Rule& rule);

// Gravity along a normal has no mirror image. Throws InputError at the plane.
void check_gravity(const std::vector<SymmetryPlane>& planes, const Vec3& gravity);

// A type whose particles stand in these planes never leaves them. Throws InputError where its constraint
// moves or pulls it out, or holds it by force.
void keep_in_planes(const std::vector<SymmetryPlane>& planes, uint8_t in, ParticleType& type);

}  // namespace cuboct
