// SPDX-License-Identifier: MIT
// The pieces of a scene's body as a run begins, which are particles that bonds connect, and how each moves.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/analysis/flight.h"
#include "model/scene/scene.h"

namespace cuboct {

struct Piece {
  // Along one axis: whether some particles are held or led along it, and the box of those, m.
  struct Hold {
    bool any = false;
    Vec3 low = Vec3::Constant(INFINITY), high = -low;
  };

  std::string name;  // of the material of its first particle
  std::vector<uint32_t> ids;
  size_t pieces = 1;  // more: what many small ones would be as one, whose velocities have any direction
  double mass = 0;    // kg
  Vec3 low = Vec3::Constant(INFINITY), high = -low;  // m, the box of its particles
  std::array<Hold, 3> hold;
  bool driven = false;  // some are held or led, along some axis
  bool fixed = false;   // all are held along all axes, at rest
  Ranges led;           // m/s, velocities of those that are led; 0 among them
  Vec3 acceleration =
      Vec3::Zero();              // m/s^2, along each axis the mean by mass of those that are free along it
  double most_acceleration = 0;  // m/s^2, of one of them
  bool pulled = false;           // a force pulls some
  // Along each axis of those that are free along it: the mean velocity, m/s; the rotation about their centre
  // of mass, 1/s and m; what either leaves, by axis the largest, and its root mean square, m/s; of all the
  // velocities' bounds.
  Vec3 velocity = Vec3::Zero(), spin = Vec3::Zero(), centre = Vec3::Zero();
  Vec3 inner = Vec3::Zero();
  double inner_rms = 0;
  Ranges velocities;

  bool steers(int axis) const { return hold[static_cast<size_t>(axis)].any; }
  Vec3 size() const { return high - low; }
};

// By their least particle. Bonds are the pairs that are within their reach as the run begins; those of
// materials that only touch are none. Of more than `most` pieces those that nothing holds or leads are
// gathered into one, and where that is not enough those that are fixed, and the others.
std::vector<Piece> pieces_of(const Scene& scene, size_t most);

}  // namespace cuboct
