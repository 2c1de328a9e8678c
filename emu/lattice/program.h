// SPDX-License-Identifier: MIT
// The command line of `cuboct-lattice`: scene and arch in, trace out.
#pragma once

#include "emu/lattice/ranks.h"

namespace cuboct::emu {

// Parses, runs, writes the trace. Returns the exit code: 0 done, 1 the run stopped on a fault or was
// interrupted (the trace is written all the same), 2 the input or the command line is wrong. Of `ranks` that
// share the scene the first writes and prints; the others must find the same files.
int run_lattice_program(int argc, char** argv, Ranks* ranks = nullptr);

// Whether cuboct-lattice was built with MPI.
bool lattice_has_mpi();

}  // namespace cuboct::emu
