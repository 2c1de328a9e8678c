// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "cli/emit.h"
#include "hw/rtl_emit.h"
#include "model/base/interrupt.h"
#include "model/base/progress.h"
#include "model/base/text.h"
#include "synth/fitter.h"
#include "synth/tool.h"

namespace cuboct {
namespace {

void say(const std::string& what) {
  if (stderr_is_terminal()) fmt::print(stderr, "\r\033[K{}", what.empty() ? "" : "fit: " + what + " ...");
}

// Nothing of the progress is left where a search ends, however it does.
struct Said {
  ~Said() { say(""); }
};

}  // namespace

int emit_fitted(const Input& input, const std::string& target, const std::string& out, uint64_t vector_steps,
                const BoardChoice& board) {
  const synth::Target& device = synth::fit_target(target, board);
  check_emit_directory(out);
  catch_interrupts();
  try {
    synth::Fitter fitter(input.scene, input.arch, device, board, say);
    {
      const Said said;
      fitter.choose();
    }
    const Setup setup = fitter.setup();
    const std::string table = fitter.table();
    emit_rtl(setup.plan, setup.initial, out, vector_steps, board, fitter.arch_text());
    fmt::print("{}{:<16} {}/arch.toml\n", block_text(table), "arch", line_text(out));
    say_emitted(out, setup.plan);
  } catch (const synth::ToolFailed& error) {
    fmt::print(stderr, "{}\n", line_text(error.what()));
    return 1;
  } catch (const synth::Interrupted&) {
    fmt::print(stderr, "interrupted; nothing was written\n");
    return 1;
  }
  return 0;
}

}  // namespace cuboct
