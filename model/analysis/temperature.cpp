// SPDX-License-Identifier: MIT
#include "model/analysis/temperature.h"

#include <algorithm>
#include <cmath>

namespace cuboct {
namespace {

// Whether particles can come to differ in their motion along `axis`. Of a flat sheet and of a straight chain
// none can along some axes: pairs then have no force along it.
bool alive(const Scene& scene, int axis) {
  const Body& body = scene.body;
  const double same = 1e-9 * scene.rule.law->cutoff();
  const ParticleType& first = scene.rule.types[body.type[0]];
  for (size_t i = 0; i < body.size(); ++i) {
    const ParticleType& type = scene.rule.types[body.type[i]];
    if (std::abs(body.x[i][axis] - body.x[0][axis]) > same || body.v[i][axis] != body.v[0][axis] ||
        type.gravity[axis] != first.gravity[axis] || type.velocity[axis] != first.velocity[axis])
      return true;
  }
  return false;
}

}  // namespace

Thermometer::Thermometer(const Scene& scene) : mass_(scene.rule.mass), boltzmann_(scene.boltzmann) {
  for (const uint8_t type : scene.body.type)
    for (int a = 0; a < 3; ++a) free_[a] += is_free(scene.rule.types[type], a);
  for (int a = 0; a < 3; ++a)
    if (free_[a] > 1 && alive(scene, a)) degrees_ += static_cast<double>(free_[a] - 1);
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
