// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>

#include "cli/answer.h"
#include "cli/command.h"
#include "model/base/text.h"
#include "synth/flow.h"
#include "synth/tool.h"

namespace cuboct {

void add_synth(CLI::App& app, int&) {
  struct Options {
    synth::Request request;
    Answer answer;
  };
  auto options = std::make_shared<Options>();
  synth::Request& request = options->request;
  CLI::App* command =
      app.add_subcommand("synth", "what an emitted project takes on an FPGA or in standard cells");
  command->add_option("project", request.directory, "directory that cuboct emit wrote")
      ->required()
      ->type_name("DIR");
  command->add_option("--target", request.target, "up5k, hx8k, ecp5-25, ecp5-85, xc7 or asic")
      ->required()
      ->type_name("T");
  command
      ->add_option("--unit", request.unit,
                   "node, lattice, board, or one block by its name: pipe, update, fifo#1, ...")
      ->type_name("UNIT")
      ->capture_default_str();
  command->add_option("--seed", request.seed, "of the placer")
      ->check(CLI::Range(0, 1 << 30))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--freq", request.frequency, "MHz that placing aims at; default: the target's")
      ->check(CLI::Range(1.0, 1000.0))
      ->type_name("F");
  command->add_flag("!--no-place", request.place,
                    "stop at the netlist: resources without Fmax and bitstream");
  command
      ->add_option("--timing", request.timing,
                   "nextpnr's report, made elsewhere from the netlist that is here")
      ->type_name("FILE");
  command->add_option("--liberty", request.liberty, "asic: standard cells; default: Debian's osu018")
      ->type_name("FILE");
  command->add_option("--activity", request.activity, "asic: changes of each net per clock, for the power")
      ->check(CLI::Range(0.0, 2.0))
      ->type_name("A")
      ->capture_default_str();
  options->answer.add_to(*command);
  command->callback([options] {
    const synth::Request& asked = options->request;
    try {
      const synth::Report report = synth::synthesise(asked);
      options->answer.say("{}{:<22} {}\n", block_text(synth::print_table(report)), "files",
                          line_text(synth::results_directory(asked)));
      options->answer.close(synth::report_json(report));
    } catch (const synth::ToolFailed& error) {
      throw Failed(error.what(),
                   fmt::format("its log is {}.failed/{}", synth::results_directory(asked), error.log));
    } catch (const synth::Interrupted&) {
      throw Failed("interrupted; nothing was written");
    }
  });
}

}  // namespace cuboct
