// SPDX-License-Identifier: MIT
// The part of an emitted project that puts the lattice behind a bus.
#pragma once

#include <map>
#include <string>

#include "hw/rtl/board.h"
#include "hw/rtl/rtl_design.h"

namespace cuboct {

// Throws InputError with the numbers where the host link cannot address the lattice, and with the nearest
// spelling where there is no such bus.
void legalise_bus(const Plan& plan, const BoardChoice& choice);

// By path in the project, files.f and README.md left out.
std::map<std::string, std::string> print_bus(const Plan& plan, const RtlDesign& design,
                                             const BoardChoice& choice);

// What README.md says of the bus.
std::string print_bus_readme(const Plan& plan, const BoardChoice& choice);

}  // namespace cuboct
