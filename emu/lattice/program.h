// SPDX-License-Identifier: MIT
// The command line of `cuboct-lattice`: scene and arch in, trace out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cuboct::emu {

// Parses, runs, writes the trace. Returns the exit code: 0 done, 1 the run stopped on a fault or was interrupted
// (the trace is written all the same), 2 the input or the command line is wrong.
int run_lattice_program(int argc, char** argv);

// Steps from a file, one per line; empty lines are passed over. Ascending and each once in the answer. Throws
// InputError with file and line.
std::vector<uint64_t> read_steps(const std::string& path);

// Whether cuboct-lattice was built with MPI.
bool lattice_has_mpi();

}  // namespace cuboct::emu
