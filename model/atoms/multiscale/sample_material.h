// SPDX-License-Identifier: MIT
// What is known of a sample before any element is strained: its edge without stress, whether it is stable,
// its elastic constants.
#pragma once

#include <memory>

#include "model/atoms/multiscale/atomic_sample.h"
#include "model/base/mat3.h"
#include "model/solid/dynamical_matrix.h"

namespace cuboct {

struct SampleMaterial {
  std::shared_ptr<const AtomicLaw> law;
  AtomicLattice lattice;
  Relaxation relaxation;
  double energy = 0;                    // eV per atom
  Matrix6 constants = Matrix6::Zero();  // Pa, Voigt order, lattice axes: the atoms give way
  Matrix6 clamped = Matrix6::Zero();    // the same, were the atoms nailed to the strain
  double softest = 0;                   // eV/angstrom^2, the least stiffness of a vibration of the sample

  double edge(int cells) const { return lattice.cell(0, 0) / cells; }  // angstrom
};

// The sample of cells^3 cubic cells whose stress is 0, its edge within a factor of 1.2 of `guess`
// (angstrom). `force`: of Relaxation. Refused by InputError: a law without such an edge, one under which the
// lattice is no minimum (a vibration of the sample is not restored, the constants are not positive definite).
SampleMaterial crystal_material(Crystal crystal, std::shared_ptr<const AtomicLaw> law, double guess,
                                int cells, double mass, double force);

// Symmetric: half of (F^T F - 1), Green's strain of a deformation gradient.
Mat3 green_strain(const Mat3& gradient);
// Voigt's vector of a strain (shears twice) times constants, as a symmetric matrix.
Mat3 stress_of(const Matrix6& constants, const Mat3& strain);

}  // namespace cuboct
