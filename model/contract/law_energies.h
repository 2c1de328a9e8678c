// SPDX-License-Identifier: MIT
// A law's energy at many distances.
#pragma once

#include <span>

#include "model/contract/rule.h"

namespace cuboct {

// J: law.energy() of each r (m), without a call for each.
void energies_of(const PairLaw& law, std::span<const double> r, std::span<double> energy);

}  // namespace cuboct
