// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>

#include "cli/command.h"
#include "cli/emit.h"
#include "hw/rtl_emit.h"
#include "model/base/text.h"
#include "model/run/static_engine.h"
#include "model/scene/config.h"

namespace cuboct {
namespace {

// The text of the arch where it is the one that an earlier --fit left in the project: it stays there.
std::string chosen_before(const std::string& arch, const std::string& out) {
  std::error_code none;
  if (arch.empty() || !std::filesystem::equivalent(arch, std::filesystem::path(out) / "arch.toml", none))
    return {};
  return read_config_text(arch);
}

}  // namespace

void say_emitted(const std::string& out, const Plan& plan) {
  fmt::print("{}: {} nodes, {} particles, plan {:016x}\n", line_text(out), plan.nodes(), plan.particles,
             plan.hash);
}

void add_emit(CLI::App& app, int& exit_code) {
  struct Options {
    Input input;
    std::string out, fit;
    uint64_t vector_steps = 8;
    BoardChoice board;
    bool fixed_velocities = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("emit", "write the scene's machine as a self-contained RTL project");
  options->input.add_to(*command);
  options->input.add_start_to(*command);
  command->add_option("--out", options->out, "directory, new or of an earlier emission")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--vector-steps", options->vector_steps, "steps of golden that the project's bench checks")
      ->check(whole_number())
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option(
          "--fit", options->fit,
          "choose brick, lanes and pipes so that the scene fits this device in the fewest cycles: up5k, "
          "hx8k, ecp5-25, ecp5-85 or xc7")
      ->type_name("TARGET");
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
  command->callback([options, &exit_code] {
    options->board.velocities = !options->fixed_velocities;
    if (!options->board.name.empty()) bit_clocks16(board_of(options->board.name), options->board.baud);
    if (!options->fit.empty()) {
      if (!options->input.stage.empty() || !options->input.from.empty())
        throw InputError("--fit chooses a machine for a scene that begins with its packing",
                         "emit without --fit takes --stage and --from");
      exit_code =
          emit_fitted(options->input, options->fit, options->out, options->vector_steps, options->board);
      return;
    }
    const Loaded loaded = load(options->input);
    refuse_static(loaded.scene, "hardware");
    const Plan& plan = loaded.setup.plan;
    emit_rtl(plan, loaded.setup.initial, options->out, options->vector_steps, options->board,
             chosen_before(options->input.arch, options->out));
    say_emitted(options->out, plan);
  });
}

}  // namespace cuboct
