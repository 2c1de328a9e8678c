// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cstdio>

#include "cli/machine/emit.h"
#include "cli/machine/machine_cycles.h"
#include "hw/rtl/rtl_emit.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"
#include "model/base/text.h"
#include "synth/board_fit.h"
#include "synth/fitter.h"
#include "synth/tool.h"

namespace cuboct {
namespace {

void say(const std::string& what) {
  if (stderr_is_terminal()) fmt::print(stderr, "\r\033[K{}", what.empty() ? "" : "fit: " + what + " ...");
}

// A line that stays.
void tell(const std::string& line) {
  say("");
  fmt::print(stderr, "fit: {}\n", line);
  std::fflush(stderr);
}

// Nothing of the progress is left where a search ends, however it does.
struct Said {
  ~Said() { say(""); }
};

}  // namespace

void check_board(const Input& input, const Plan& plan, const State& initial, const BoardChoice& board) {
  catch_interrupts();
  try {
    const Said said;
    if (synth::check_board_fit(input.scene, plan, initial, board, say) == synth::FitCheck::memories)
      fmt::print(stderr,
                 "note: of the fit only memories were checked: yosys or nextpnr-ice40 is not in PATH\n");
  } catch (const synth::ToolFailed& error) {
    throw Failed(error.what());
  } catch (const synth::Interrupted&) {
    throw Failed("interrupted; nothing was written");
  }
}

void emit_fitted(const Input& input, const std::string& target, const std::string& out, Emission emission,
                 const Answer& answer) {
  const synth::Target& device = synth::fit_target(target, emission.board);
  check_emit_directory(out);
  catch_interrupts();
  try {
    synth::Fitter fitter(input.scene, input.arch, device, emission.board, say, tell);
    try {
      const Said said;
      fitter.choose();
    } catch (const synth::Interrupted&) {
      if (fitter.kept().empty()) throw;
      throw Failed("interrupted; nothing was written",
                   fmt::format("the syntheses that ended are in {}: the same command goes on from there",
                               fitter.kept()));
    }
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
  } catch (const synth::Interrupted&) {
    throw Failed("interrupted; nothing was written");
  }
}

}  // namespace cuboct
