// SPDX-License-Identifier: MIT
#include "emu/lattice/program.h"

int main(int argc, char** argv) { return cuboct::emu::run_lattice_program(argc, argv); }
