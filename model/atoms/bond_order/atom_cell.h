// SPDX-License-Identifier: MIT
// Perfect crystals of covalent atoms, and what a cell of them is worth under Tersoff's potential: its rest,
// energy and elastic constants, with and without what its atoms give way within it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/atoms/bond_order/tersoff_forces.h"
#include "model/base/mat3.h"

namespace cuboct {

struct AtomCell {
  AtomBox box;
  std::vector<Vec3> x;
};

// Diamond, edge `a` of the cubic cell: its two-atom cell, or nx ny nz cubes of eight atoms.
AtomCell diamond_cell(double a);
AtomCell diamond_block(double a, int nx, int ny, int nz);
// Graphene in the plane z = 0, zigzag rows along x: nx ny rectangles of four atoms, sqrt(3) bonds wide and 3
// high, periodic in x and y. The third edge, of `thickness`, is what stresses are over.
AtomCell graphene_sheet(double bond, double thickness, int nx, int ny);

// The cell stretched: box and atoms by 1 + strain.
AtomCell strained(const AtomCell& cell, const Mat3& strain);

// Moves the atoms, in the box as it is, to where no force is above `force`. Newton's method with a Hessian by
// differences: for cells of a few atoms, near a minimum. std::runtime_error where it does not end.
void rest_within(TersoffForces& forces, AtomCell& cell, double force);

// The cell scaled, along the axes that repeat, so that its mean stress along them is zero, and its energy at
// rest.
AtomCell at_no_pressure(TersoffForces& forces, const AtomCell& cell);

// The largest eigenvalue of d2E/dx2, in energy/length^2: of the stiffest motion that repeats with the box.
// From below, within a part in a thousand.
double largest_curvature(TersoffForces& forces, const AtomCell& cell);

// Per volume of the box, tension positive.
Mat3 stress_of(TersoffForces& forces, const AtomCell& cell);

using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct CellConstants {
  double energy = 0;  // per atom
  // In energy per volume: Cauchy stress that a small strain adds, Voigt order xx, yy, zz, yz, xz, xy with
  // engineering shear strains; rows and columns of axes that do not repeat are 0.
  Matrix6d relaxed = Matrix6d::Zero();
  Matrix6d clamped = Matrix6d::Zero();
  Mat3 stress = Mat3::Zero();  // tension positive, of the cell itself
};

// By central differences of the virial at strains of +-1e-5: the differences' own error is some 1e-8 of a
// constant.
CellConstants constants_of(TersoffForces& forces, const AtomCell& cell);

// eV/angstrom^3 in GPa (CODATA 2018, exact).
inline constexpr double kGpaOfEvPerA3 = 160.2176634;

}  // namespace cuboct
