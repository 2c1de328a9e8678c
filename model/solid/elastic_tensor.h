// SPDX-License-Identifier: MIT
// The elastic constants of a cell at rest by lattice sums: Born's term, less what its particles give way
// within it. M. Born and K. Huang, Dynamical Theory of Crystal Lattices (1954), sections 11 and 24; D. C.
// Wallace, Thermodynamics of Crystals (1972), sections 2 and 7.
#pragma once

#include "model/base/mat3.h"
#include "model/solid/crystal_cell.h"
#include "model/solid/dynamical_matrix.h"

namespace cuboct {

struct ElasticTensor {
  // Pa, Voigt order xx, yy, zz, yz, xz, xy with engineering shear strains: Cauchy stress that a small strain
  // adds (the convention of elastic_constants). Of a strain that leaves an axis which does not repeat: 0.
  Matrix6 c = Matrix6::Zero();
  Matrix6 born = Matrix6::Zero();  // the same, were the particles nailed to the strain
  Mat3 stress = Mat3::Zero();      // Pa, tension positive, of the cell itself
  double residual = 0;             // N, the largest force on a particle, which is to be at rest
};

// With pairs of energy U, Lagrangian strain n and displacements w of the particles besides it, r^2 = (d +
// w)^T (1 + 2n) (d + w). So at rest, with g = (U'' - U'/r)/r^2 and sums over the bonds of all particles,
//   d2E/dn_ab dn_cd = 1/2 sum g d_a d_b d_c d_d,
//   d2E/dw_ia dn_bc = -sum over bonds of i of g d_a d_b d_c = -L,    d2E/dw dw = K (force constants),
// and the least energy over w has the constants (Born - L^T K^-1 L)/V. Translations, at 0 in K, are left out.
// Dense up to a few hundred degrees of freedom, conjugate gradients beyond. std::runtime_error where K has
// negative eigenvalues, or the iterations do not end: the cell is at no minimum.
ElasticTensor elastic_tensor(const Rule& rule, const CrystalCell& cell);

// From derivatives of the energy by Lagrangian strain to those of the Cauchy stress by strain: B_abcd =
// C_abcd + (t_ad e_bc + t_bd e_ac + t_ac e_bd + t_bc e_ad - 2 t_ab e_cd)/2, t the stress, e Kronecker's
// symbol.
Matrix6 stress_strain(const Matrix6& lagrangian, const Mat3& stress);

}  // namespace cuboct
