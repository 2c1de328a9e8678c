// SPDX-License-Identifier: MIT
// What a scene says of its motion before it runs: how fast, and how far it strains its bonds. Estimates, to
// within a factor of a few, from closed forms; formats of numbers are chosen by them.
#pragma once

#include <cstdint>
#include <string>

#include "model/scene/scene.h"

namespace cuboct {

// What makes the strain that Motion tells.
enum class StrainCause : uint8_t { none, said, imposed, force, gravity, bending, initial, rotation };

struct Motion {
  double slowest_imposed = 0;  // m/s, the least speed but 0 of a type that is moved
  double gravity = 0;          // m/s^2, the least but 0
  double initial_speed = 0;    // m/s, root mean square of the particles that move freely at the start
  // N/m, of the bond between nearest neighbours, strongest materials; of a rule of rounds that of a
  // particle's stiffest motion; 0: unknown
  double bond_stiffness = 0;
  double sound_speed = 0;    // m/s, of waves along a row of such bonds, or of the rule's fastest; 0: unknown
  double rest_distance = 0;  // m, between nearest neighbours
  // The largest strain that the scene makes, as far as the following tell; 0: nothing does. With c the speed
  // of sound, T the duration and L the body's longest side:
  //   moved types        max(V/c, V T/L), V their largest difference of velocity, to the body or to one
  //   another:
  //                      a wave carries V/c, and each time it crosses the body as much is added
  //   gravity            min(g T/c, g L/c^2): of a body under its own weight, before and after a wave crossed
  //   it gravity, bending   min(3 g l^2/(c^2 h), 3 h g T^2/(4 l^2)): of a part that reaches l beyond what
  //   holds the body,
  //                      across gravity, h high along it: at rest (Euler and Bernoulli's beam), and what its
  //                      end falls until then
  //   force              min(a T/c, a d/c^2), a the acceleration by it and d the depth of what it pulls: the
  //   stress behind those particles
  //   initial motion     V/c, V the root mean square about the motion of a rigid body, or the mean against
  //   what is held
  //                      or moved
  //   initial rotation   (V/c)^2, V the root mean square of the rotation
  double strain = 0;
  StrainCause cause = StrainCause::none;
  std::string strain_of;  // which of them, "the velocity imposed on 'pulled'"
};

inline constexpr double kMostStrain = 0.2;  // a crystal holds no more

// Whether something holds the type's particles, moves or steers them.
bool driven(const ParticleType& type);

Motion motion_of(const Scene& scene);

}  // namespace cuboct
