// SPDX-License-Identifier: MIT
// Common-neighbour analysis: which crystal a particle's nearest neighbours are of.
//
// Sources: J. D. Honeycutt, H. C. Andersen, J. Phys. Chem. 91 (1987) 4950. With a cutoff: D. Faken, H.
// Jonsson, Comput. Mater. Sci. 2 (1994) 279, as LAMMPS's `compute cna/atom`. Without one: A. Stukowski,
// Model. Simul. Mater. Sci. Eng. 20 (2012) 045021, as OVITO's adaptive analysis.
#pragma once

#include <cstdint>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

// Numbers as OVITO has them. LAMMPS has the same, and 5 for `other`.
enum class Structure : uint8_t { other, fcc, hcp, bcc, icosahedral };
inline constexpr int kStructures = 5;
const char* to_string(Structure structure);

// Two of a particle's neighbours that are nearer than the cutoff have a bond. A neighbour j has the signature
// (common, bonds, least, most): neighbours that it has in common with the particle, bonds between those, and
// the fewest and most of them at one. A particle is
//   fcc          12 neighbours, all (4, 2, 1, 1)
//   hcp          12 neighbours, six (4, 2, 1, 1) and six (4, 2, 0, 2)
//   bcc          14 neighbours, six (4, 4, 2, 2) and eight (6, 6, 2, 2)
//   icosahedral  12 neighbours, all (5, 5, 2, 2)
// and else other.

// Of neighbours within `cutoff` (m): between first and second shell of a close packing, or between second and
// third of bcc. By id.
std::vector<Structure> structures_within(const std::vector<Vec3>& x, const Periodic& periodic, double cutoff,
                                         int threads = 0);

// Of the 12 nearest neighbours with the cutoff (1 + sqrt 2)/2 times their mean distance; or, where that gives
// `other`, of the 14 nearest with (1 + sqrt 2)/2 times the mean over 14 of 2/sqrt 3 times the distance of the
// nearest eight and that of the next six. Neighbours are looked for within `reach` (m); who has fewer there
// is `other`.
std::vector<Structure> structures_adaptive(const std::vector<Vec3>& x, const Periodic& periodic, double reach,
                                           int threads = 0);

}  // namespace cuboct
