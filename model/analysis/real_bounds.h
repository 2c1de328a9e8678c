// SPDX-License-Identifier: MIT
// How far a run in floats or doubles may be from the exact one: bounds by the roundings of the gpu engine's
// arithmetic, which counts positions from the corners of cells. Derived in docs/reference/gpu.md, "Floats".
#pragma once

#include <vector>

#include "model/scene/scene.h"

namespace cuboct {

// What one precision loses.
struct Roundings {
  double unit = 0;        // u: half an ulp of 1
  double position = 0;    // m, each time that a position is rounded; length of the vector
  double difference = 0;  // m, of the difference of two positions
};
Roundings gpu_roundings(const Scene& scene, bool floats);
Roundings reference_roundings(const Scene& scene);  // in doubles, positions from the scene's origin

// At one state.
struct ForceBounds {
  std::vector<double> force;  // N, by particle: error of its pair force at positions and velocities as given
  double stiffness = 0;  // N/m: largest change of any particle's pair force by its own and the others' places
  double friction = 0;   // kg/s: the same by velocities
};
ForceBounds force_bounds(const Scene& scene, const std::vector<Vec3>& x, const std::vector<Vec3>& v,
                         const Roundings& of);

// The largest errors of any particle of a run, step by step by semi-implicit Euler.
class ErrorGrowth {
 public:
  ErrorGrowth(const Scene& scene, const Roundings& of) : scene_(scene), of_(of), x_(of.position) {}
  // A step that begins in a state of these bounds, whose fastest particle has `speed` (m/s).
  void step(const ForceBounds& bounds, double speed);
  double position() const { return x_; }  // m

 private:
  const Scene& scene_;
  Roundings of_;
  double x_, v_ = 0;
  bool begun_ = false;
};

}  // namespace cuboct
