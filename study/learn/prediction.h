// SPDX-License-Identifier: MIT
// The learned solid beside the atoms: what it predicts of a crack, and how far that is off (sections 5.2 to
// 5.4 of the paper).
#pragma once

#include "study/learn/crack_body.h"
#include "study/learn/fracture_samples.h"

namespace cuboct::learn {

// What a grid has of a run of atoms.
struct CrackData {
  const Grid& grid;
  const std::vector<double>& density;
  const std::vector<Vec3>& velocity;
  const std::vector<Frame>& frames;
};

struct CrackState {
  std::vector<Vec3> u;
  std::vector<double> damage;
};
// Of the displacements that atoms have: damage as the solid's bonds have it along them.
std::vector<CrackState> seen(const CrackData& data, const Kernel& kernel, const Breaking& breaking,
                             double slit);
// Of the solid in time, by central differences. Points within the collar move as the atoms do; between frames
// displacements and loads are straight lines.
std::vector<CrackState> predict(const CrackData& data, const Kernel& kernel, const Breaking& breaking,
                                double slit, double interval, const PredictionInput& input);

// Points that are free.
std::vector<size_t> inside(const Grid& grid, double collar);

// Of each frame from the second on the root of the sum of squares of the difference over points, over that of
// what was seen; then the mean over frames, and that of their squares.
struct CrackErrors {
  double displacement = 0, damage = 0;
  double displacement_squares = 0, damage_squares = 0;
};
CrackErrors errors_of(const std::vector<CrackState>& predicted, const std::vector<CrackState>& seen,
                      const std::vector<size_t>& points);

// Phase two (equations 41 and 42): the relative residual of the equation of motion over the frames of the
// training, for a critical stretch.
double stretch_residual(const CrackData& data, const Kernel& kernel, const Breaking& breaking, double slit,
                        const std::array<int, 2>& frames, const std::vector<size_t>& points);

}  // namespace cuboct::learn
