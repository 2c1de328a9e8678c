// SPDX-License-Identifier: MIT
// What detectors see of a run at one step (model/analysis/watch.h), in SI units.
#pragma once

#include <cstdint>
#include <functional>

#include "model/analysis/measure.h"

namespace cuboct {

// Functions take an id and are called only for what a detector needs.
struct Moment {
  uint64_t step = 0;
  std::function<Vec3(uint32_t)> x;       // m
  std::function<Vec3(uint32_t)> v;       // m/s, before the kick of this step
  std::function<Vec3(uint32_t)> v_next;  // m/s, after it
  std::function<Vec3(uint32_t)> u;       // m, from the anchor of a controller; empty where none is known
  std::function<Vec3(uint32_t)> force;   // N, of the pairs
  double noise = 0;                      // m/s: slower motion is rounding
  const FixedRule* fixed = nullptr;      // of an engine of integers
  Energies energies;
  ClosestPair closest;
};

}  // namespace cuboct
