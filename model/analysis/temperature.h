// SPDX-License-Identifier: MIT
// The kinetic temperature of a run: T = 2 K/(g k_B), with K the kinetic energy of the free particles about
// the velocity of their centre of mass and g their degrees of freedom. docs/reference/trace.md,
// "Temperature", says which scenes have it.
#pragma once

#include <array>
#include <cstdint>

#include "model/analysis/measure.h"
#include "model/scene/scene.h"

namespace cuboct {

class Thermometer {
 public:
  explicit Thermometer(const Scene& scene);
  // Whether the scene has a temperature: particles are free, and it draws thermal velocities, or is one of
  // undamped molecules.
  bool wanted() const { return wanted_; }
  double degrees() const { return degrees_; }
  double temperature(const FreeMotion& motion) const;  // K, in reduced units J; of a scene that has one
  const char* unit() const { return temperature_unit(boltzmann_); }

 private:
  double mass_, boltzmann_;
  std::array<double, 3> free_mass_{};  // over mass_, of the particles that nothing drives along each axis
  double degrees_ = 0;
  bool wanted_ = false;
};

}  // namespace cuboct
