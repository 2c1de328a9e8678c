// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "hw/rtl_emit.h"

namespace cuboct {

void add_emit(CLI::App& app, int&) {
  struct Options {
    Input input;
    std::string out;
    uint64_t vector_steps = 8;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("emit", "write the scene's machine as a self-contained RTL project");
  options->input.add_to(*command);
  command->add_option("--out", options->out, "directory, new or of an earlier emission")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--vector-steps", options->vector_steps, "steps of golden that the project's bench checks")
      ->check(whole_number())
      ->type_name("N")
      ->capture_default_str();
  command->callback([options] {
    const Loaded loaded = load(options->input);
    const Plan& plan = loaded.setup.plan;
    emit_rtl(plan, loaded.setup.initial, options->out, options->vector_steps);
    fmt::print("{}: {} nodes, {} particles, plan {:016x}\n", options->out, plan.lattice.size(),
               plan.particles, plan.hash);
  });
}

}  // namespace cuboct
