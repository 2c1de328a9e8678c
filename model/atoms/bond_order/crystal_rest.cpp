// SPDX-License-Identifier: MIT
#include "model/atoms/bond_order/crystal_rest.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace cuboct {
namespace {

// The cell scaled to the least energy of 41 bonds from half of the potential's whole reach to all of it.
AtomCell near_rest(TersoffForces& forces, AtomLattice lattice) {
  constexpr int kTried = 40;
  const TersoffTerm<double>& t = forces.tersoff().terms[0];
  AtomCell best;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= kTried; ++k) {
    const AtomCell cell = right_cell(lattice, (t.R - t.D) * (0.5 + 0.5 * k / kTried));
    stress_of(forces, cell);
    if (forces.energy() < least) least = forces.energy(), best = cell;
  }
  return best;
}

// Large enough that no atom has two bonds to one other, and that the stiffest motion fits into it.
AtomCell several(AtomLattice lattice, double bond) {
  return lattice == AtomLattice::graphene ? graphene_sheet(bond, bond, 4, 2)
                                          : diamond_block(bond * 4 / std::numbers::sqrt3, 2, 2, 2);
}

// rho c^2 of the fastest long wave: C11 of the sheet, which is isotropic; of the cube the larger of C11 along
// [100] and (C11 + 2 C12 + 4 C44)/3 along [111].
double fastest_wave(const CellConstants& constants, AtomLattice lattice) {
  const Matrix6d& c = constants.relaxed;
  if (lattice == AtomLattice::graphene) return c(0, 0);
  return std::max(c(0, 0), (c(0, 0) + 2 * c(0, 1) + 4 * c(3, 3)) / 3);
}

}  // namespace

AtomCell right_cell(AtomLattice lattice, double bond) {
  return lattice == AtomLattice::graphene ? graphene_sheet(bond, bond, 1, 1)
                                          : diamond_block(bond * 4 / std::numbers::sqrt3, 1, 1, 1);
}

CrystalRest crystal_rest(const Tersoff& tersoff, AtomLattice lattice) {
  TersoffForces forces(tersoff);
  const AtomCell cell = at_no_pressure(forces, near_rest(forces, lattice));
  const CellConstants constants = constants_of(forces, cell);
  CrystalRest rest;
  // Of the two edges along x: sqrt(3) bonds, and 4/sqrt(3).
  rest.bond = cell.box.edges(0, 0) *
              (lattice == AtomLattice::graphene ? 1 / std::numbers::sqrt3 : std::numbers::sqrt3 / 4);
  rest.energy = constants.energy;
  rest.curvature = largest_curvature(forces, several(lattice, rest.bond));
  const double volume = cell.box.volume() / static_cast<double>(cell.x.size());
  rest.wave = fastest_wave(constants, lattice) * volume;
  return rest;
}

}  // namespace cuboct
