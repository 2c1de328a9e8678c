// SPDX-License-Identifier: MIT
#include "model/analysis/flight.h"

#include <algorithm>
#include <cmath>

namespace cuboct {
namespace {

double way(double v, double g, double s) { return (v + 0.5 * g * s) * s; }

// The largest of v s' + g s'^2/2 for s' from 0 to s: at an end, or where the velocity v + g s' is 0, v^2/(2
// |g|).
double farthest(double v, double g, double s) {
  double most = std::max(0.0, way(v, g, s));
  if (v > 0 && g < 0 && -v / g < s) most = std::max(most, -v * v / (2 * g));
  return most;
}

}  // namespace

void Flight::clip(Ranges& places) const {
  places.low = places.low.cwiseMax(-stop_low_);
  places.high = places.high.cwiseMin(stop_high_);
}

Ranges Flight::places(double t) const {
  const double s = t - since_;
  Ranges at = begin_;
  for (int a = 0; a < 3; ++a) {
    at.low[a] += way(velocity_.low[a], acceleration_[a], s);
    at.high[a] += way(velocity_.high[a], acceleration_[a], s);
  }
  return at;
}

Ranges Flight::until(double t) const {
  const double s = t - since_;
  Ranges all = before_;
  for (int a = 0; a < 3; ++a) {
    const double g = acceleration_[a];
    all.low[a] = std::min(all.low[a], begin_.low[a] - farthest(-velocity_.low[a], -g, s));
    all.high[a] = std::max(all.high[a], begin_.high[a] + farthest(velocity_.high[a], g, s));
  }
  clip(all);
  return all;
}

Ranges Flight::velocity(double t) const {
  const double s = t - since_;
  Ranges v{velocity_.low + acceleration_ * s, velocity_.high + acceleration_ * s};
  v.low = v.low.cwiseMax(-most_speed_).cwiseMin(most_speed_);
  v.high = v.high.cwiseMin(most_speed_).cwiseMax(-most_speed_);
  return v;
}

void Flight::hit(double t, const Ranges& velocity) {
  const Ranges now = this->velocity(t);
  before_ = until(t);
  begin_ = places(t);
  clip(begin_);
  since_ = t;
  velocity_.low = now.low.cwiseMin(velocity.low);
  velocity_.high = now.high.cwiseMax(velocity.high);
  most_speed_ = most_speed_.cwiseMax(velocity_.low.cwiseAbs()).cwiseMax(velocity_.high.cwiseAbs());
}

void Flight::stop(int axis, int side, double distance, double speed) {
  double& at = side == 0 ? stop_low_[axis] : stop_high_[axis];
  at = std::min(at, std::max(0.0, distance));
  most_speed_[axis] = std::min(most_speed_[axis], speed);
}

void Flight::drop_stop(int axis, int side) {
  (side == 0 ? stop_low_ : stop_high_)[axis] = INFINITY;
  most_speed_[axis] = INFINITY;
}

}  // namespace cuboct
