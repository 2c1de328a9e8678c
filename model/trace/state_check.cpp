// SPDX-License-Identifier: MIT
#include "model/trace/state_check.h"

#include <fmt/format.h>

#include "model/base/error.h"

namespace cuboct {

std::string out_of_bounds(const Particle& particle, const StateBounds& bounds) {
  const auto not_below = [](const char* what, uint64_t value, uint64_t limit) {
    return fmt::format("{} {} is not below {}", what, value, limit);
  };
  if (particle.id >= bounds.particles) return not_below("id", particle.id, bounds.particles);
  if (particle.type >= bounds.types) return not_below("type", particle.type, bounds.types);
  if (particle.cell >= bounds.cells) return not_below("cell", particle.cell, bounds.cells);
  for (const int64_t x : particle.x)
    if (x < 0 || x >> bounds.position_bits != 0) return fmt::format("position {} is outside its cell", x);
  const int64_t fastest = int64_t{1} << (bounds.velocity_bits - 1);
  for (const int64_t v : particle.v)
    if (v < -fastest || v >= fastest)
      return fmt::format("velocity {} is out of {} bits", v, bounds.velocity_bits);
  return "";
}

void check_frames(const Trace& trace, const StateBounds& bounds, const std::string& path) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{} is no trace of this scene: {}", path, what));
  };
  const auto check_count = [&](uint64_t step, uint64_t particles) {
    if (particles != bounds.particles)
      fail(fmt::format("the frame of step {} has {} particles, the scene {}", step, particles,
                       bounds.particles));
  };
  for (const State& frame : trace.frames) {
    check_count(frame.step, frame.particles.size());
    for (size_t k = 0; k < frame.particles.size(); ++k) {
      const Particle& p = frame.particles[k];
      std::string wrong = out_of_bounds(p, bounds);
      if (wrong.empty() && p.id != k) wrong = fmt::format("id {} stands in row {}", p.id, k);
      if (!wrong.empty()) fail(fmt::format("frame of step {}, particle {}: {}", frame.step, k, wrong));
    }
  }
  for (const RealFrame& body : trace.bodies) check_count(body.step, body.x.size());
}

}  // namespace cuboct
