// SPDX-License-Identifier: MIT
#include "model/analysis/temperature.h"

#include <algorithm>

namespace cuboct {
Thermometer::Thermometer(const Scene& scene) : mass_(scene.rule.mass), boltzmann_(scene.boltzmann) {
  for (const uint8_t type : scene.body.type)
    for (int a = 0; a < 3; ++a) free_[a] += is_free(scene.rule.types[type], a);
  const std::array<bool, 3> live = live_axes(scene);
  for (int a = 0; a < 3; ++a)
    if (free_[a] > 1 && live[a]) degrees_ += static_cast<double>(free_[a] - 1);
  wanted_ = degrees_ > 0 && (scene.thermal || !(scene.rule.damping.coefficient > 0));
}

double Thermometer::temperature(const FreeMotion& motion) const {
  double energy = motion.kinetic;
  for (int a = 0; a < 3; ++a)
    if (free_[a] > 0)
      energy -= mass_ * motion.velocities[a] * motion.velocities[a] / (2 * static_cast<double>(free_[a]));
  return 2 * std::max(energy, 0.0) / (degrees_ * boltzmann_);
}

}  // namespace cuboct
