// SPDX-License-Identifier: MIT
#include <cstdlib>
#include <systemc>

#include "emu/machine/program.h"
#include "emu/systemc/node.h"
#include "model/base/standard_streams.h"

int sc_main(int argc, char** argv) {
  return cuboct::exit_code_of([&] {
    return cuboct::emu::run_machine(argc, argv,
                                    {.name = "cuboct-systemc",
                                     .description = "Runs a scene on cycle-accurate nodes in SystemC",
                                     .engine = "systemc",
                                     .text = true,
                                     .nodes = cuboct::emu::native_nodes});
  });
}

// Instead of SystemC's own main, which would print a banner first.
int main(int argc, char** argv) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return cuboct::with_standard_streams([&] { return sc_core::sc_elab_and_sim(argc, argv); });
}
