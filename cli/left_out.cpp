// SPDX-License-Identifier: MIT
// What this build was configured without: it is on the command line all the same, and says so when asked.
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/machine/boards.h"
#include "cli/machine/emit.h"
#include "cli/study/learn.h"
#include "hw/program/options.h"
#include "model/base/error.h"

namespace cuboct {
namespace {

// `part` completes "built without ..."; `option` is CMake's.
[[noreturn, maybe_unused]] void refuse(const std::string& asked, const char* part, const char* option) {
  throw InputError(fmt::format("{}: this cuboct was built without {}", asked, part),
                   fmt::format("configure with -D{}=ON", option));
}

// Whatever its arguments.
[[maybe_unused]] void add_left_out(Command& app, const std::string& name, const char* part,
                                   const char* option) {
  Command command = app.command(name, fmt::format("left out: built without {}", part));
  command.any_words();
  command.callback([name, part, option] { refuse(name, part, option); });
}

}  // namespace

#ifndef CUBOCT_HAS_STUDIES
void add_explore(Command& app, int&) { add_left_out(app, "explore", "studies", "CUBOCT_STUDIES"); }
void add_pitch(Command& app, int&) { add_left_out(app, "pitch", "studies", "CUBOCT_STUDIES"); }
void add_stability(Command& app, int&) { add_left_out(app, "stability", "studies", "CUBOCT_STUDIES"); }
#endif

#ifndef CUBOCT_HAS_FITS
void add_fit(Command& app, int&) { add_left_out(app, "fit", "fits", "CUBOCT_FITS"); }
#endif

#ifndef CUBOCT_HAS_LEARN
void add_learn(Command& app, int&) { add_left_out(app, "learn", "studies and NLopt", "CUBOCT_STUDIES"); }
#endif

#ifndef CUBOCT_HAS_SYNTH
void add_synth(Command& app, int&) { add_left_out(app, "synth", "synthesis", "CUBOCT_SYNTH"); }
void emit_fitted(const Input&, const std::string&, const std::string&, uint64_t, const BoardChoice&,
                 const Answer&) {
  refuse("emit --fit", "synthesis", "CUBOCT_SYNTH");
}
DeviceRoom device_room(const Plan&, const std::string&) {
  refuse("boards --device", "synthesis", "CUBOCT_SYNTH");
}
void check_board(const Input&, const Plan&, const State&, const BoardChoice&) {
  fmt::print(stderr, "note: the fit was not checked: this cuboct was built without synthesis\n");
}
#endif

}  // namespace cuboct
