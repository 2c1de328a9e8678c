// SPDX-License-Identifier: MIT
// How far from where they begin a scene's particles can come, as closed forms tell it before the run: what
// [reach] margin = "auto" builds cells for, beside one cell edge. Estimates, as those of motion.h: a run that
// leaves them stops with a fault. Energy that the body stores as it begins counts for nothing.
//
// Pieces of the body are particles that bonds connect. T is the duration, c the speed of sound, Y = 2/3 c^2
// modulus over density in the softest direction of a packing, L a piece's longest side, h its side along the
// motion, e the strain at which its law pulls most, u the speed at which two pieces meet.
//
// Flight along an axis along which no particle of a piece is held or led: the range of v t + g t^2/2 up to T.
// v is the piece's mean velocity, g its mean acceleration by gravity and forces.
//
// Rotation about an axis, where nothing holds or leads the piece along the other two: each particle stays on
// its circle about the centre of mass, as far as it turns in T.
//
// What is led: V T. Where max(V/c, V T/L) is above e it breaks and springs back: e L along V, e L/2 across.
//
// A load along an axis along which some of a piece is held or led, with the mean acceleration a: a stretch of
// a h^2/(2 Y), and the bending of what reaches l beyond the held part, 1.5 a l^4/(Y h^2) (Euler and
// Bernoulli's cantilever); of a force, which may act at the end, 4 a l^4/(Y h^2). Twice that, as of a load
// that comes at once. No more than a T^2/2, nor than 2 L. Where a h/Y or 3 a l^2/(Y h) is above e the piece
// tears off, and flies.
//
// Inner velocities v, which no rigid body has, and those of a held piece: 2 v L^2/(c h), twice the speed over
// the frequency of the slowest bending, no more than v T. Each particle flies at its own velocity where v/c
// is above e; of drawn velocities, where their root mean square is above 0.2 c (Lindemann: atoms swing by a
// tenth of their distance); of a rotation, where it strains by more than e.
//
// An impact, from when the boxes of two pieces may meet. Where u/c is below e both stay whole: a piece of
// mass m gets up to 2 M/(m + M) u along the normal, as in an elastic impact, and 1/50 of u across it. A held
// piece sways by inner velocities. One that is struck off its middle tumbles, within the sphere about it.
// Where u/c is above e, what is struck flies with up to 2.5 u ahead, u/4 back and u across (fragments of
// scenes/templates/impact.toml: 2.2, 0 and 0.65); what strikes loses up to 1.25 u, and gets u across.
//
// A stop: a piece that is held as a whole, along all axes, ends what comes along an axis, where the shadow of
// what comes falls wholly on it, wherever flight takes it across the axis until T. A later blow that takes it
// past the wall ends the stop.
//
// Static loading has no flights: paths of what is led, loads without doubling, and breaks are left.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "model/analysis/flight.h"
#include "model/scene/scene.h"

namespace cuboct {

struct PieceReach {
  std::string name;   // of its material
  size_t pieces = 1;  // that are told as one
  Ranges beyond;      // m, low <= 0 <= high: of particles that nothing holds or leads
  std::array<std::array<std::string, 2>, 3> stopped_by;  // by axis, below and above; empty: by nothing
  std::vector<std::string> reasons;                      // "gravity", "an impact"
  Vec3 spin = Vec3::Zero();                              // 1/s: `beyond` is without the rotation
  Vec3 centre = Vec3::Zero();                            // m, about which they turn
  double duration = 0;                                   // s

  // Of a particle that begins at x: with the rotation, and no axis along which its type is held or led.
  Ranges of(const Vec3& x, const ParticleType& type) const;
};

struct MotionReach {
  std::vector<PieceReach> pieces;
  std::vector<uint32_t> piece;  // by particle
};

MotionReach motion_reach(const Scene& scene);

// The largest of all particles to either side, m, without what led types do on their way.
Vec3 largest_beyond(const Scene& scene, const MotionReach& reach);

// A line for people, the pieces that come further than `edge`, m, first: "'rubber' -z 48.5 mm, to 'ground',
// +z 50 mm, by gravity and an impact; else 707 um".
std::string reach_text(const Scene& scene, const MotionReach& reach, double edge);

}  // namespace cuboct
