// SPDX-License-Identifier: MIT
#include "model/analysis/temperature.h"

#include <algorithm>

#include "model/rules/rounds_rule.h"

namespace cuboct {
namespace {

// kg, some 6 million atomic masses: of the heaviest molecules. What is heavier stands for matter whose heat
// lies within it.
constexpr double kHeaviestMolecule = 1e-20;

bool are_molecules(const Scene& scene) {
  const bool reduced = scene.boltzmann == 1;
  return !has_reference_bonds(scene.rule) && (reduced || scene.rule.heaviest() < kHeaviestMolecule);
}

}  // namespace

Thermometer::Thermometer(const Scene& scene) : mass_(scene.rule.mass), boltzmann_(scene.boltzmann) {
  std::array<uint64_t, 3> free{};  // particles that nothing drives along each axis
  for (const uint8_t type : scene.body.type)
    for (int a = 0; a < 3; ++a)
      if (is_free(scene.rule.types[type], a)) ++free[a], free_mass_[a] += scene.rule.relative_mass(type);
  const std::array<bool, 3> live = live_axes(scene);
  for (int a = 0; a < 3; ++a)
    if (free[a] > 1 && live[a]) degrees_ += static_cast<double>(free[a] - 1);
  wanted_ =
      degrees_ > 0 && (scene.thermal || (are_molecules(scene) && !(scene.rule.damping.coefficient > 0)));
}

double Thermometer::temperature(const FreeMotion& motion) const {
  double energy = motion.kinetic;
  for (int a = 0; a < 3; ++a)
    if (free_mass_[a] > 0)
      energy -= mass_ * motion.velocities[a] * motion.velocities[a] / (2 * free_mass_[a]);
  return 2 * std::max(energy, 0.0) / (degrees_ * boltzmann_);
}

}  // namespace cuboct
