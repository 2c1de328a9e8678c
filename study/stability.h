// SPDX-License-Identifier: MIT
// The largest stable time step of a scene: measured on an engine, beside what theory says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/arch.h"
#include "model/reference.h"
#include "model/scene.h"
#include "study/settings.h"

namespace cuboct::study {

// What is asked: small motions about the scene's body as it stands (velocities, imposed velocities and
// gravity are taken off), stretched by `strain` along `axis` first, without lateral motion.
struct StabilityCase {
  Arithmetic arithmetic = Arithmetic::float64;
  Integrator integrator = Integrator::semi_implicit_euler;
  int axis = 0;
  double strain = 0;  // 0.1: ten per cent
};

struct MeasuredLimit {
  double stable = 0, unstable = 0;  // s: the bisection's bracket, within `resolution` of each other
  uint64_t steps = 0;               // of each trial
  std::string sign;                 // what the unstable side showed: "energy grew by ...", a fault's text
};

// By bisection on the engine, from `guess` (s; 0: from the theory) to a relative `resolution`.
MeasuredLimit measured_limit(const Scene& scene, const Arch& arch, const StabilityCase& c, double guess,
                             double resolution);

// Whether a run at `dt` is stable: the trial that the bisection makes; for maps.
bool is_stable(const Scene& scene, const Arch& arch, const StabilityCase& c, double dt);

}  // namespace cuboct::study
