// SPDX-License-Identifier: MIT
// Tersoff's bond order as a rule of two rounds. The first makes, of a particle's own neighbours, its energy
// and the partial forces on them; the second collects those that the neighbours made.
// docs/reference/tersoff.md.
#pragma once

#include <memory>
#include <string>

#include "model/atoms/bond_order/crystal_rest.h"
#include "model/base/atom_units.h"
#include "model/rules/rounds_rule.h"

namespace cuboct {

// `name`: of the set or file, for people. `tersoff`: of one element, in eV and angstrom. `rest`: in the same
// units, of the crystal that the time step is meant for.
std::shared_ptr<const RoundsRule> tersoff_rule(const std::string& name, const Tersoff& tersoff,
                                               const CrystalRest& rest);

}  // namespace cuboct
