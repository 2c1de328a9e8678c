// SPDX-License-Identifier: MIT
// The command line of `cuboct-lattice`: scene and arch in, trace out.
#pragma once

namespace cuboct::emu {

// Parses, runs, writes the trace. Returns the exit code: 0 done, 1 the run stopped on a fault or was interrupted
// (the trace is written all the same), 2 the input or the command line is wrong.
int run_lattice_program(int argc, char** argv);

// Whether cuboct-lattice was built with MPI.
bool lattice_has_mpi();

}  // namespace cuboct::emu
