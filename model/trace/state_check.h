// SPDX-License-Identifier: MIT
// Whether states from a file can be of a scene: their numbers are indices into its particles, types and
// cells.
#pragma once

#include <cstdint>
#include <string>

#include "model/trace/trace.h"

namespace cuboct {

// What the scene has.
struct StateBounds {
  uint64_t particles = 0;
  uint64_t types = 0;
  uint64_t cells = 0;
  int position_bits = 0;  // of a position within its cell
  int velocity_bits = 0;
};

// "type 7 is not below 2": the first number that is out of bounds; empty where all are in.
std::string out_of_bounds(const Particle& particle, const StateBounds& bounds);

// InputError that names `path`, the frame, the particle and the first number that is out of bounds.
void check_frames(const Trace& trace, const StateBounds& bounds, const std::string& path);

}  // namespace cuboct
