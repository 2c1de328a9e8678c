// SPDX-License-Identifier: MIT
#include "emu/systemc/node.h"
#include "emu/systemc/program.h"

// main() is SystemC's.
int sc_main(int argc, char** argv) {
  return cuboct::emu::run_program(argc, argv,
                                  {.name = "cuboct-systemc",
                                   .description = "Runs a scene on cycle-accurate nodes in SystemC",
                                   .engine = "systemc",
                                   .nodes = cuboct::emu::native_nodes});
}
