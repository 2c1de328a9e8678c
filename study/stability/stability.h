// SPDX-License-Identifier: MIT
// The largest stable time step of a scene: measured on an engine, beside what theory says.
#pragma once

#include <cstdint>
#include <string>

#include "hw/arch/arch.h"
#include "model/real/reference.h"
#include "model/scene/scene.h"
#include "model/solid/vibrations.h"
#include "study/sweep/interrupted.h"
#include "study/sweep/settings.h"

namespace cuboct::study {

// A body at rest, about which small motions are asked for: velocities, imposed velocities and gravity of the
// scene are taken off.
struct Subject {
  Scene scene;
  Limit limit;       // of its vibrations
  std::string note;  // what was done to bring it to rest, or why it has no limit to measure; may be empty
  bool measurable = true;
};

// The scene's body as it stands; one that is not at rest (the surface of a Lennard-Jones crystal) is relaxed
// first, by FIRE (model/base/fire.h). With `strain` (0.1: ten per cent) it
// is then stretched along `axis` without lateral motion. The ends of a stretched body would spring back: each
// of its particles is given a constant force against that, as gravity of its type, so that it rests as it is
// stretched. Where that takes more types than there may be, it is not measurable.
Subject subject_of(const Scene& scene, int axis = 0, double strain = 0);

// What of a scene takes part.
struct Parts {
  bool damping = true, strengths = true, imposed = true, pd = true;
};
Scene with_parts(Scene scene, const Parts& parts);

struct Method {
  Arithmetic arithmetic = Arithmetic::float64;
  Integrator integrator = Integrator::semi_implicit_euler;  // fixed knows this one only
  int threads = 1;
};

// The functions below throw Interrupted once model/base/interrupt.h was asked to stop.

enum class TrialVerdict : uint8_t {
  stable,
  unstable,
  refused,  // the formats hold no such dt: the fixed rule cannot be made
};
struct Trial {
  TrialVerdict verdict = TrialVerdict::stable;
  std::string sign;  // what an unstable run showed: a growth, a fault's text; the refusal
};
// A run of `steps` steps from small random displacements and velocities (seeded). It looks at the part of the
// motion that flips from step to step, y = w[n] - 2 w[n-1] + w[n-2] with w the displacement of a step: modes
// leave the unit circle at -1 (model/solid/vibrations.h), where |y| = 4 |w|, while slow motion cancels. The
// run is unstable where the largest |y| of all particles
//   - grows beyond what a stable mode can swing to that is `resolution` (relative) below its limit:
//     1/sqrt(8 resolution) of its start, with a factor of 4 of room; or
//   - is three times as large in the last quarter as in the second, and larger than at the start;
// or where the engine stops: a fault, a position that is not finite.
Trial try_step(const Subject& subject, const Arch& arch, const Method& method, double dt, double resolution,
               uint64_t steps);

// Steps that tell a dt `resolution` beyond the limit. There a mode grows by the factor z of the quadratic in
// model/solid/vibrations.h, exp(sqrt(8 resolution)) per step where nothing damps; with damping it is slower.
uint64_t steps_to_tell(const Limit& limit, double resolution);

struct MeasuredLimit {
  double stable = 0, unstable = 0;  // s: the bisection's bracket, within the resolution of each other
  uint64_t steps = 0;               // of each trial
  int trials = 0;
  bool refused = false;  // the unstable end is a refusal: the formats end before stability does
  std::string sign;      // of the unstable end
  double middle() const { return (stable + unstable) / 2; }
};
// By bisection on the engine, from the theory's limit, which only saves trials: the bracket grows until it
// holds the change. Throws InputError where the engine cannot hold the scene at any dt.
MeasuredLimit measured_limit(const Subject& subject, const Arch& arch, const Method& method,
                             double resolution);

}  // namespace cuboct::study
