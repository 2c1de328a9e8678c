// SPDX-License-Identifier: MIT
// What a watch over a run finds (model/analysis/watch.h), as it travels in a trace.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "model/base/vec.h"

namespace cuboct {

enum class Failure : uint8_t {
  time_step,        // velocities flip from step to step: dt is beyond the stability limit
  damping,          // the same, and the damping's share of the limit is the larger
  stiff_hold,       // the same, by the gains of PD controllers
  force_jump,       // the law's force jumps at its cutoff: energies scatter in first order of dt
  tunnelling,       // a pair inside the law's core, where the force rolls off, or fast enough to cross it
  constraint_work,  // driven particles press harder, or feed in more energy, than the body's bonds hold
  heating,          // a run that should keep its energy does not: too few value bits make steps
  creep,            // a body at rest moves by itself
  far_origin,       // float32 positions whose spacing is not small beside the pitch
  resolution,       // motion or strain that the engine's formats cannot show
};
inline constexpr int kFailures = static_cast<int>(Failure::resolution) + 1;
const char* to_string(Failure failure);  // as in docs: "time step", ...

struct Finding {
  Failure failure = Failure::time_step;
  uint64_t step = 0;
  std::optional<uint32_t> particle;  // where the failure has one
  Vec3 place = Vec3::Zero();         // m
  double number = 0, limit = 0;      // what was measured, and what it may be; same unit
  std::string text;                  // one line: "step 120: ... particle 17 at (...) m: ... 1.3 > 1"
};

}  // namespace cuboct
