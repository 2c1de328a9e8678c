// SPDX-License-Identifier: MIT
// Ideal cleavage: the energy that parts a crystal along a plane, G = 2 gamma, with both faces left as they
// were cut. A crack that grows slowly in a brittle body takes so much per area (A. A. Griffith, Phil. Trans.
// R. Soc. A 221 (1921) 163).
#pragma once

#include "model/solid/crystal_cell.h"

namespace cuboct {

// J/m^2. A plane of unit normal n cuts, per area, |n.d|/V of each kind of bond d that a cell of volume V has:
// (1/V) sum of -U(|d|) |n.d|, each bond once. Of a cell with several particles it is the mean over all places
// of the plane.
double cleavage_energy(const Rule& rule, const CrystalCell& cell, const Vec3& normal);

// Unit normals of the planes of least and of most energy, of a cell whose pairs all attract. Between the
// planes that hold a bond the energy is linear in n, so that on the unit sphere its minima are planes that
// hold two bonds, and its maxima fixed points of n -> gradient.
struct CleavagePlanes {
  Vec3 weakest, strongest;
};
CleavagePlanes cleavage_planes(const Rule& rule, const CrystalCell& cell);

}  // namespace cuboct
