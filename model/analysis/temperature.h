// SPDX-License-Identifier: MIT
// The kinetic temperature of a run: T = 2 K/(g k_B), with K the kinetic energy of the free particles about
// their mean velocity and g their degrees of freedom. docs/reference/trace.md, "Temperature", says which
// scenes have it.
#pragma once

#include <array>
#include <cstdint>

#include "model/analysis/measure.h"
#include "model/scene/scene.h"

namespace cuboct {

class Thermometer {
 public:
  explicit Thermometer(const Scene& scene);
  // Whether the scene has a temperature: it is undamped, or draws thermal velocities, and particles are free.
  bool wanted() const { return wanted_; }
  double degrees() const { return degrees_; }
  double temperature(const FreeMotion& motion) const;  // K, in reduced units J; of a scene that has one
  const char* unit() const { return temperature_unit(boltzmann_); }

 private:
  double mass_, boltzmann_;
  std::array<uint64_t, 3> free_{};  // particles that nothing drives along each axis
  double degrees_ = 0;
  bool wanted_ = false;
};

}  // namespace cuboct
