// SPDX-License-Identifier: MIT
// The crystals of covalent atoms that scenes are made of, and what a potential says of them at rest.
#pragma once

#include <cstdint>

#include "model/atoms/bond_order/atom_cell.h"

namespace cuboct {

enum class AtomLattice : uint8_t { graphene, diamond };

// The smallest cell with a right-angled box whose nearest neighbours are `bond` apart: of graphene four
// atoms, sqrt(3) by 3 bonds, and a bond thick; of diamond the cube of eight.
AtomCell right_cell(AtomLattice lattice, double bond);

// Of the crystal without pressure, in the units of the parameters.
struct CrystalRest {
  double bond = 0;       // length, between nearest neighbours
  double energy = 0;     // of an atom
  double curvature = 0;  // energy/length^2: the largest of d2E/dx2, mass times the largest frequency squared
  double wave = 0;       // energy: an atom's mass times the square of the fastest long wave's speed
};

// std::runtime_error where the lattice has no rest between half of the distance at which the potential begins
// to fall and all of it.
CrystalRest crystal_rest(const Tersoff& tersoff, AtomLattice lattice);

}  // namespace cuboct
