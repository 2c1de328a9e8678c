// SPDX-License-Identifier: MIT
// How far particles are from where they were, through any number of periods of a box.
#pragma once

#include <cstdint>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

class DisplacementMeter {
 public:
  // `wrapped`: positions stand in the box, and a particle's way between two frames is the shortest of its
  // images. Else they are not wrapped, and no frame between the first and this one matters.
  DisplacementMeter(const Periodic& periodic, bool wrapped) : periodic_(periodic), wrapped_(wrapped) {}

  // Frames ascend in their steps; `v` (m/s) and `dt` (s) say how fast the whole moves; no `v`: nobody does.
  // InputError where a particle, or by its velocity the whole, moves more than a quarter of a period between
  // two frames: through how many periods is then not known.
  void add(uint64_t step, const std::vector<Vec3>& x, const std::vector<Vec3>& v, double dt);

  // m, since the first frame.
  const std::vector<Vec3>& moved() const { return moved_; }

 private:
  void check(uint64_t step, const std::vector<Vec3>& ways, const Vec3& drift, double dt) const;

  Periodic periodic_;
  bool wrapped_;
  uint64_t step_ = 0;
  Vec3 drift_ = Vec3::Zero();  // m/s, mean of the latest frame
  std::vector<Vec3> latest_, moved_;
};

// m^2, along each axis: the mean over the particles `counted` (by id; empty: all) of their displacement's
// square. `masses` (kg, by id): the displacement is that about the motion of those particles' centre of mass;
// empty: as it is.
Vec3 mean_squared(const std::vector<Vec3>& moved, const std::vector<char>& counted,
                  const std::vector<double>& masses);

}  // namespace cuboct
