// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/machine/emit.h"
#include "cli/machine/machine_cycles.h"
#include "cli/machine/one_synthesis.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/interrupt.h"
#include "model/base/text.h"
#include "synth/board_fit.h"
#include "synth/fitter.h"
#include "synth/target.h"
#include "synth/tool.h"

namespace cuboct {

void check_board(const Input& input, const Plan& plan, const State& initial, const BoardChoice& board) {
  catch_interrupts();
  try {
    ToolLines lines("fit");
    const synth::Target& target = synth::target_of(board_of(board.name).target);
    if (synth::check_board_fit(input.scene, plan, initial, board, hears_of_synthesis(lines, target)) ==
        synth::FitCheck::memories)
      fmt::print(stderr,
                 "note: of the fit only memories were checked: yosys or nextpnr-ice40 is not in PATH\n");
  } catch (const synth::ToolFailed& error) {
    throw Failed(error.what());
  } catch (const synth::Interrupted& stop) {
    throw interrupted_tools(stop, "syntheses");
  }
}

void emit_fitted(const Input& input, const std::string& target, const std::string& out, Emission emission,
                 const Answer& answer) {
  const synth::Target& device = synth::fit_target(target, emission.board);
  check_emit_directory(out);
  catch_interrupts();
  try {
    ToolLines lines("fit");
    synth::Fitter fitter(input.scene, input.arch, device, emission.board, lines.says(), lines.tells());
    try {
      fitter.choose();
    } catch (synth::Interrupted& stop) {
      stop.kept = fitter.kept();
      throw;
    }
    lines.wipe();
    const Setup setup = fitter.setup();
    const std::string table = fitter.table();
    const std::optional<CountedCycles> counted = count_cycles(setup.plan, setup.initial, fitter.steps());
    emission.arch = fitter.arch_text();
    emission.counted = counted;
    emit_rtl(setup.plan, setup.initial, out, emission);
    answer.say("{}{:<16} {}/arch.toml\n", block_text(table), "arch", line_text(out));
    if (counted)
      answer.say("{:<16} {:.1f}, the mean of the first {} steps, counted; the most {}\n", "cycles per step",
                 counted->mean(), counted->steps, counted->most);
    Items items = say_emitted(out, setup.plan, counted, answer);
    items.add("target", target);
    items.add("arch", out + "/arch.toml");
    if (answer.json) answer.close(items);
  } catch (const synth::ToolFailed& error) {
    throw Failed(error.what());
  } catch (const synth::Interrupted& stop) {
    throw interrupted_tools(stop, "syntheses");
  }
}

}  // namespace cuboct
