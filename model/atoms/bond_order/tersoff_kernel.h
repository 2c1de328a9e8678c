// SPDX-License-Identifier: MIT
// Tersoff forces in two sweeps over groups of atoms, each atom a lane of a vector. The first makes for each
// atom i and neighbour j the partial force G_ij = dE_i/d(x_j - x_i); the second sums F_i = sum_j (G_ij -
// G_ji). Z. Fan et al., Phys. Rev. B 92 (2015) 094301. Whoever owns an atom computes all that is added to it,
// in the order of its list: threads and widths of vectors leave no mark in the bits.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "model/atoms/bond_order/bond_list.h"
#include "model/atoms/bond_order/tersoff_parameters.h"

namespace cuboct {

// What both sweeps read and write. Records are four numbers a place: three coordinates, and in x the element.
struct TersoffSweep {
  const BondList* list = nullptr;
  const double* x = nullptr;  // records of all places
  double* partial = nullptr;  // G_ij: a record for each entry of the list
  double* force = nullptr;    // a record for each slot
  double* energy = nullptr;   // E_i, for each slot; null: not asked for
  // xx, yy, zz, yz, xz, xy of the symmetric part of sum_j d_ij G_ij: [(group * 6 + k) * lanes + lane]; null
  // as energy is.
  double* virial = nullptr;
};

// Numbers that the first sweep needs for itself, a thread each, for groups of up to `rows` rows.
size_t tersoff_scratch(size_t rows);

// The first sweep over groups [first, last), of one element; force gets the sum of the atoms' own partial
// forces.
void tersoff_partials(const TersoffTerm<double>& term, const TersoffSweep& sweep, size_t first, size_t last,
                      double* scratch);
// The same for several elements, an atom after another, from the formulas of tersoff_terms.h.
void tersoff_scalar_partials(const Tersoff& tersoff, const TersoffSweep& sweep, size_t first, size_t last);
// The second sweep.
void tersoff_collect(const TersoffSweep& sweep, size_t first, size_t last);

// Lanes of a vector of doubles on this machine, and its instruction set.
size_t bond_lanes();
const char* bond_simd();

}  // namespace cuboct
