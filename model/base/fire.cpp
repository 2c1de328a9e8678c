// SPDX-License-Identifier: MIT
#include "model/base/fire.h"

#include <algorithm>
#include <cmath>

namespace cuboct {
namespace {

constexpr double kGrow = 1.1, kShrink = 0.5, kMixing = 0.25, kLessMixing = 0.99;
constexpr int kDelay = 20;
// Of the time in which the stiffest mode of unit mass swings by one radian: leapfrog is stable up to 2.
constexpr double kLongest = 1.0, kFirst = 0.2, kShortest = 0.002;

}  // namespace

FireResult fire(Eigen::VectorXd& x, const FireForces& forces, const FireOptions& options) {
  const double radian = 1 / std::sqrt(options.stiffness);
  double dt = kFirst * radian, mixing = kMixing;
  int downhill = 0;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(x.size()), v = f;
  FireResult result;
  while (true) {
    result.at_rest = forces(x, f);
    ++result.evaluations;
    if (result.at_rest || result.evaluations >= options.most) return result;
    if (f.dot(v) > 0) {
      if (++downhill > kDelay) dt = std::min(kGrow * dt, kLongest * radian), mixing *= kLessMixing;
    } else {
      // Uphill: half a step back, and a new start. The first evaluation has no motion to take back.
      x -= dt / 2 * v;
      v.setZero();
      if (result.evaluations > 1) dt = std::max(kShrink * dt, kShortest * radian);
      downhill = 0, mixing = kMixing;
    }
    v += dt * f;
    if (const double size = f.norm(); size > 0) v = (1 - mixing) * v + mixing * v.norm() / size * f;
    const double farthest = v.size() > 0 ? dt * v.cwiseAbs().maxCoeff() : 0;
    if (options.longest_step > 0 && farthest > options.longest_step) v *= options.longest_step / farthest;
    x += dt * v;
  }
}

}  // namespace cuboct
