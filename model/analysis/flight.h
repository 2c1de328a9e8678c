// SPDX-License-Identifier: MIT
// How far a body that nothing holds comes, by axis: at constant acceleration from velocities within bounds,
// which hits widen. Axes are independent, as those of a parabola are.
#pragma once

#include "model/base/vec.h"

namespace cuboct {

// Of a quantity, by axis.
struct Ranges {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  bool zero() const { return low.isZero(0) && high.isZero(0); }
};

class Flight {
 public:
  Flight() = default;
  // m/s and m/s^2
  Flight(const Ranges& velocity, const Vec3& acceleration)
      : velocity_(velocity), acceleration_(acceleration) {}

  // m from the start, of all places up to t. `t` in s, not before the latest hit.
  Ranges until(double t) const;
  // m/s, at t.
  Ranges velocity(double t) const;
  const Vec3& acceleration() const { return acceleration_; }

  // From t on velocities lie within these bounds too, m/s.
  void hit(double t, const Ranges& velocity);
  double latest_hit() const { return since_; }

  // Something stands in the way along an axis: no place is further from the start than `distance`, m, below
  // (side 0) or above (side 1), and no speed along the axis is above `speed`, m/s.
  void stop(int axis, int side, double distance, double speed);
  // From the latest hit on nothing stands there any more, nor bounds speeds along the axis.
  void drop_stop(int axis, int side);

 private:
  Ranges places(double t) const;  // at t alone, before stops
  void clip(Ranges& places) const;

  Ranges velocity_;  // at since_
  Vec3 acceleration_ = Vec3::Zero();
  double since_ = 0;
  Ranges begin_;   // places at since_
  Ranges before_;  // all places up to since_
  Vec3 stop_low_ = Vec3::Constant(INFINITY), stop_high_ = Vec3::Constant(INFINITY);
  Vec3 most_speed_ = Vec3::Constant(INFINITY);
};

}  // namespace cuboct
