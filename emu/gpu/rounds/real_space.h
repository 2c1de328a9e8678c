// SPDX-License-Identifier: MIT
// Space in integers for a rule in floats or doubles: each axis is a ring of 2^(64 - spare) units.
#pragma once

#include <array>

#include "emu/gpu/rounds/real_ring.h"
#include "model/contract/rule.h"

namespace cuboct::gpu {

struct RealSpace {
  Vec3 origin = Vec3::Zero();                      // m, where x is 0
  Vec3 unit = Vec3::Zero();                        // m, of x
  Vec3 low = Vec3::Zero(), length = Vec3::Zero();  // m, of the box, or of the body as it began
  std::array<bool, 3> wraps{};
  std::array<RealRing, 3> ring{};
  std::array<int64_t, 3> bound{};  // of x, on both sides of 0

  // Of the body, or `low` and `length` of an earlier one. `wide`: places have 64 bits. InputError where a
  // periodic extent is below two reaches.
  RealSpace(const Body& body, const Periodic& periodic, double reach, bool wide);
  RealSpace(const Vec3& low, const Vec3& length, const Periodic& periodic, double reach, bool wide);

  int64_t whole(double x, size_t axis) const;
  double metres(int64_t x, size_t axis) const;
  // m, of a difference of places.
  double place_unit(size_t axis) const;
  // Units of x that a step may move: places tell half their ring apart.
  double furthest(size_t axis, bool wide) const;
};

}  // namespace cuboct::gpu
