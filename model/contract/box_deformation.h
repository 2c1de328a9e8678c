// SPDX-License-Identifier: MIT
// A box whose lengths grow or shrink at a constant engineering strain rate. Its box at a step is a function
// of the step alone, so that a run that goes on from anywhere has the same.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// Along each periodic axis L(n) = L0 (1 + strain + n per_step), with L0 of `packed` and n the last step of
// the load that is not beyond the step asked for: a static load stands still between two. The box's origin
// stays.
struct BoxDeformation {
  Periodic packed;
  Vec3 strain = Vec3::Zero();    // 1, of step 0
  Vec3 per_step = Vec3::Zero();  // 1
  uint64_t every = 1;            // steps of the run that a step of the load takes

  bool moves() const { return !per_step.isZero(0); }
  Vec3 strain_at(uint64_t step) const { return strain + static_cast<double>(step - step % every) * per_step; }
  Periodic at(uint64_t step) const {
    Periodic box = packed;
    box.extent = box.extent.cwiseProduct(Vec3::Ones() + strain_at(step));
    return box;
  }
};

// The affine motion of what a box carries along when it becomes another one of the same origin.
struct BoxStretch {
  Vec3 origin = Vec3::Zero();  // m
  Vec3 ratio = Vec3::Ones();   // along each axis, of the lengths; 1 along open ones

  BoxStretch(const Periodic& from, const Periodic& to) : origin(from.origin) {
    for (int axis = 0; axis < 3; ++axis)
      if (from.extent[axis] > 0) ratio[axis] = to.extent[axis] / from.extent[axis];
  }
  Vec3 operator()(const Vec3& x) const { return origin + ratio.cwiseProduct(x - origin); }
  void carry(std::vector<Vec3>& x) const {
    for (Vec3& one : x) one = (*this)(one);
  }
};

// m: how far two particles may each move, about the motion of the box, before they come within `reach` (m) of
// each other, where they stood `listed` (m) apart or more when the box was `then`. No vector has become
// shorter than by the least of the axes' ratios.
inline double allowed_motion(double reach, double listed, const Periodic& then, const Periodic& now) {
  const double shortest = std::min(1.0, BoxStretch(then, now).ratio.minCoeff());
  return (shortest * listed - reach) / 2;
}

}  // namespace cuboct
