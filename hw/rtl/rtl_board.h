// SPDX-License-Identifier: MIT
// The part of an emitted project that makes a board of it.
#pragma once

#include <map>
#include <string>

#include "hw/rtl/board.h"
#include "hw/rtl/rtl_design.h"

namespace cuboct {

// Throws InputError with the numbers where the host link cannot address the lattice.
void legalise_machine(const Plan& plan);
// cuboct_machine_pkg: what the host link knows of the plan.
std::string print_machine_package(const Plan& plan, const RtlDesign& design);

// As legalise_machine, and where the board cannot have the line.
void legalise_board(const Plan& plan, const BoardChoice& choice);

// By path in the project, files.f and README.md left out.
std::map<std::string, std::string> print_board(const Plan& plan, const RtlDesign& design,
                                               const BoardChoice& choice);

// files.f of a folder, board or bus: every module of the project, in the order to read. `lattice_list`: the
// project's files.f.
std::string list_with(const std::string& lattice_list, const std::string& folder,
                      const std::map<std::string, std::string>& files);

// What README.md says of the board.
std::string print_board_readme(const Plan& plan, const BoardChoice& choice);

}  // namespace cuboct
