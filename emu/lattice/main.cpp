// SPDX-License-Identifier: MIT
#include "emu/lattice/program.h"
#include "model/base/standard_streams.h"

#ifdef CUBOCT_LATTICE_MPI
#include <cstdlib>

#include "emu/lattice/mpi_ranks.h"
#include "model/base/process.h"

namespace {

// Alone, without mpirun (Open MPI, MPICH, Slurm), MPI is not even started.
int run(int argc, char** argv) {
  for (const char* launcher : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
    if (std::getenv(launcher)) {
      cuboct::end_with_starter();  // mpirun's end is ours, before anything can wait for other ranks
      cuboct::emu::MpiRanks ranks(&argc, &argv);
      return cuboct::emu::run_lattice_program(argc, argv, &ranks);
    }
  return cuboct::emu::run_lattice_program(argc, argv);
}

}  // namespace
#else
namespace {
int run(int argc, char** argv) { return cuboct::emu::run_lattice_program(argc, argv); }
}  // namespace
#endif

int main(int argc, char** argv) {
  return cuboct::with_standard_streams([&] { return run(argc, argv); });
}
