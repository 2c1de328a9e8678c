// SPDX-License-Identifier: MIT
// The part of an emitted project that makes a board of it.
#pragma once

#include <map>
#include <string>

#include "hw/board.h"
#include "hw/rtl_design.h"

namespace cuboct {

// Throws InputError with the numbers where the host link cannot address the lattice.
void legalise_board(const Plan& plan, const BoardChoice& choice);

// By path in the project, files.f and README.md left out.
std::map<std::string, std::string> print_board(const Plan& plan, const RtlDesign& design,
                                               const BoardChoice& choice);

// board/files.f: every module of the project, in the order to read. `lattice_list`: the project's files.f.
std::string board_list(const std::string& lattice_list, const std::map<std::string, std::string>& files);

// What README.md says of the board.
std::string print_board_readme(const Plan& plan, const BoardChoice& choice);

}  // namespace cuboct
