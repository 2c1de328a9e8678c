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
    BoardChoice board;
    bool fixed_velocities = false;
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
  auto* board = command
                    ->add_option("--board", options->board.name,
                                 "add a top module, pins and a host link: icebreaker or ulx3s")
                    ->type_name("B");
  command->add_option("--baud", options->board.baud, "bits per second of the board's serial line")
      ->needs(board)
      ->capture_default_str()
      ->type_name("N");
  command
      ->add_flag("--fixed-velocities", options->fixed_velocities,
                 "the host cannot set the velocities of held and moved types: less area")
      ->needs(board);
  command->callback([options] {
    options->board.velocities = !options->fixed_velocities;
    if (!options->board.name.empty()) bit_clocks16(board_of(options->board.name), options->board.baud);
    const Loaded loaded = load(options->input);
    const Plan& plan = loaded.setup.plan;
    emit_rtl(plan, loaded.setup.initial, options->out, options->vector_steps, options->board);
    fmt::print("{}: {} nodes, {} particles, plan {:016x}\n", options->out, plan.lattice.size(),
               plan.particles, plan.hash);
  });
}

}  // namespace cuboct
