// SPDX-License-Identifier: MIT
// How the vertices of a body move: equations 1, 2 and 4 in time, or to rest.
#pragma once

#include <Eigen/SparseCholesky>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/atoms/multiscale/element_body.h"

namespace cuboct {

// N, on each vertex, besides what its elements do; added to `force`.
using VertexLoad = std::function<void(double time, std::vector<Vec3>& force)>;

// Velocity Verlet of the vertices.
class ElementMotion {
 public:
  // At time 0, `v` (m/s) at rest unless set. Relaxes the samples of the body as it stands.
  ElementMotion(ElementBody& body, double dt, VertexLoad load = {});

  void step();

  std::vector<Vec3>& v() { return v_; }  // m/s
  const std::vector<Vec3>& v() const { return v_; }
  double time() const { return static_cast<double>(steps_) * dt_; }
  uint64_t steps() const { return steps_; }
  double kinetic_energy() const;  // J
  Vec3 momentum() const;          // kg m/s

  // Goes on at a step of an earlier run, whose body and velocities are back.
  void restore(uint64_t steps);

 private:
  void forces();

  ElementBody& body_;
  double dt_;
  VertexLoad load_;
  uint64_t steps_ = 0;
  std::vector<Vec3> v_, force_;
};

struct RestResult {
  bool at_rest = false;
  int iterations = 0;  // updates of the body
  double force = 0;    // N, the largest component that is left
};

// Moves vertices to rest within a period that stays. Steps are those of the undeformed body's stiffness,
// which is factorised once: near that state an error falls by some strain at each step.
class ElementRest {
 public:
  explicit ElementRest(const ElementBody& body);
  // Until no component of a force on a vertex is above `force` (N), or after `most` updates.
  RestResult operator()(ElementBody& body, double force, int most = 60) const;

 private:
  void take_out_rigid(Eigen::VectorXd& v) const;

  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
  Eigen::MatrixXd rigid_;  // columns: motions as a whole, orthonormal
};

}  // namespace cuboct
