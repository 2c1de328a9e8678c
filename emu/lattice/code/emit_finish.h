// SPDX-License-Identifier: MIT
// Prints the finish of a round as C++ for vectors.
#pragma once

#include <string>

#include "emu/lattice/code/graph_text.h"
#include "model/graph/program.h"

namespace cuboct::emu {

// A function that the text defines, a FinishCode.
std::string name_of_finish(size_t round);

std::string finish_text(const graph::FixedProgram& program, size_t round, size_t first_table,
                        CodeConstants& constants);

}  // namespace cuboct::emu
