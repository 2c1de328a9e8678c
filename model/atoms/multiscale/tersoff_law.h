// SPDX-License-Identifier: MIT
// Tersoff's potential (model/atoms/bond_order) as samples take it.
#pragma once

#include <memory>

#include "model/atoms/bond_order/tersoff_parameters.h"
#include "model/atoms/multiscale/atomic_sample.h"

namespace cuboct {

inline constexpr double kTersoffSkin = 0.5;  // angstrom: of the bonds' lists of samples

// `tersoff` in eV and angstrom, of one element or more: the atoms are of the first.
std::shared_ptr<const AtomicLaw> tersoff_law(Tersoff tersoff);

}  // namespace cuboct
