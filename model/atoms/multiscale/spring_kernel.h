// SPDX-License-Identifier: MIT
// Forces of springs over a list of bonds, each atom a lane of a vector.
#pragma once

#include "model/atoms/bond_order/bond_list.h"
#include "model/atoms/multiscale/shell_springs.h"

namespace cuboct {

// `x`: records of four numbers of all places of the list. `sums`: [(group * 10 + k) * lanes + lane], with k
// the force (eV/angstrom) x, y, z, the energy (eV), and the virial xx, yy, zz, yz, xz, xy (eV) of the atom.
void spring_forces(const ShellSprings& springs, const BondList& list, const double* x, double* sums);

}  // namespace cuboct
