// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <memory>

#include "cli/answer.h"
#include "cli/command.h"
#include "cli/machine/tool_lines.h"
#include "cli/programs.h"
#include "hw/program/options.h"
#include "model/base/text.h"
#include "synth/flow.h"
#include "synth/tool.h"

namespace cuboct {

void add_synth(Command& app, int&) {
  struct Options {
    synth::Request request;
    bool quiet = false;
    Answer answer;
  };
  auto options = std::make_shared<Options>();
  synth::Request& request = options->request;
  Command command = add_command(app, "synth");
  command.option("project", request.directory, "directory that cuboct emit wrote", "DIR").required();
  command.option("--target", request.target, "up5k, hx8k, ecp5-25, ecp5-85, xc7 or asic", "T")
      .proposed({"up5k", "hx8k", "ecp5-25", "ecp5-85", "xc7", "asic"})
      .required();
  command
      .option("--unit", request.unit,
              "node, lattice, board, or one block by its name: pipe, update, fifo#1, ...", "UNIT")
      .show_default();
  command.option("--seed", request.seed, "of the placer", "N").range(0, 1 << 30).show_default();
  command.option("--freq", request.frequency, "MHz that placing aims at; default: the target's", "F")
      .range(1.0, 1000.0);
  command.flag("!--no-place", request.place, "stop at the netlist: resources without Fmax and bitstream");
  command.option("--timing", request.timing, "nextpnr's report, made elsewhere from the netlist that is here",
                 "FILE");
  command.option("--liberty", request.liberty, "asic: standard cells; default: Debian's osu018", "FILE");
  command.option("--activity", request.activity, "asic: changes of each net per clock, for the power", "A")
      .range(0.0, 2.0)
      .show_default();
  command.flag("-q,--quiet", options->quiet, "nothing on stderr but errors: no line for each stage");
  options->answer.add_to(command);
  command.callback([options] {
    const synth::Request& asked = options->request;
    try {
      ToolLines lines("synth", options->quiet);
      const synth::Report report = synth::synthesise(asked, {lines.says(), lines.tells()});
      lines.wipe();
      options->answer.say("{}{:<22} {}\n", block_text(synth::print_table(report)), "files",
                          line_text(synth::results_directory(asked)));
      options->answer.close(synth::report_json(report));
    } catch (const synth::ToolFailed& error) {
      throw Failed(error.what(),
                   fmt::format("its log is {}.failed/{}", synth::results_directory(asked), error.log));
    } catch (const synth::Interrupted& stop) {
      throw interrupted_tools(stop, "stages");
    }
  });
}

}  // namespace cuboct
