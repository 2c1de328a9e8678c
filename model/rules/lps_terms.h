// SPDX-License-Identifier: MIT
// The two rounds of the linear peridynamic solid on a body.
#pragma once

#include <memory>
#include <vector>

#include "model/rules/lps.h"

namespace cuboct {

// Of a neighbour's volume the share that counts at distance r: 1, or less at the horizon's edge for
// `partial`. LAMMPS tapers alike (its Peridynamics guide, section 3.3).
double share_of(const LpsMaterial& material, double r);

// `whole`: weighted volume of a particle that lacks no bond. InputError, with the particle, where its bonds
// do not span the space, or its weights are not those of a stable solid.
std::unique_ptr<RoundsTerms> make_lps_terms(const LpsMaterial& material, double whole, ReferenceBonds bonds,
                                            const std::vector<Vec3>& x, const std::vector<char>& unbreakable,
                                            int threads);

}  // namespace cuboct
