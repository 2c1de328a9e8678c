// SPDX-License-Identifier: MIT
#include <cstdlib>
#include <systemc>

#include "emu/machine/program.h"
#include "emu/verilated/verilated_node.h"
#include "hw/program/options.h"
#include "model/base/standard_streams.h"

namespace {

int run(int argc, char** argv) {
  using namespace cuboct::emu;
  std::string build_directory;
  Machine program{.name = "cuboct-rtl",
                  .description = "Runs a scene on the emitted hardware, compiled by Verilator",
                  .engine = "rtl",
                  .text = true,
                  .nodes = [&](const cuboct::Plan& plan) {
                    return verilated_nodes(
                        plan, build_directory.empty() ? default_build_directory() : build_directory);
                  }};
  program.add_options = [&](cuboct::Command& app) {
    app.option("--build-dir", build_directory,
               "Where compiled nodes are kept; $XDG_CACHE_HOME/cuboct or ~/.cache/cuboct without it");
  };
  return run_machine(argc, argv, program);
}

}  // namespace

int sc_main(int argc, char** argv) {
  return cuboct::exit_code_of([&] { return run(argc, argv); });
}

// Instead of SystemC's own main, which would print a banner first.
int main(int argc, char** argv) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return cuboct::with_standard_streams([&] { return sc_core::sc_elab_and_sim(argc, argv); });
}
