// SPDX-License-Identifier: MIT
// What this build was configured without: it is on the command line all the same, and says so when asked.
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/boards.h"
#include "cli/command.h"
#include "cli/emit.h"
#include "cli/learn.h"
#include "model/base/error.h"

namespace cuboct {
namespace {

// `part` completes "built without ..."; `option` is CMake's.
[[noreturn, maybe_unused]] void refuse(const std::string& asked, const char* part, const char* option) {
  throw InputError(fmt::format("{}: this cuboct was built without {}", asked, part),
                   fmt::format("configure with -D{}=ON", option));
}

// Whatever its arguments.
[[maybe_unused]] void add_left_out(CLI::App& app, const std::string& name, const char* part,
                                   const char* option) {
  CLI::App* command = app.add_subcommand(name, fmt::format("left out: built without {}", part));
  command->prefix_command();
  command->set_help_flag();
  command->callback([name, part, option] { refuse(name, part, option); });
}

}  // namespace

#ifndef CUBOCT_HAS_STUDIES
void add_explore(CLI::App& app, int&) { add_left_out(app, "explore", "studies", "CUBOCT_STUDIES"); }
void add_pitch(CLI::App& app, int&) { add_left_out(app, "pitch", "studies", "CUBOCT_STUDIES"); }
void add_stability(CLI::App& app, int&) { add_left_out(app, "stability", "studies", "CUBOCT_STUDIES"); }
#endif

#ifndef CUBOCT_HAS_FITS
void add_fit(CLI::App& app, int&) { add_left_out(app, "fit", "fits", "CUBOCT_FITS"); }
#endif

#ifndef CUBOCT_HAS_LEARN
void add_learn(CLI::App& app, int&) { add_left_out(app, "learn", "studies and NLopt", "CUBOCT_STUDIES"); }
#endif

#ifndef CUBOCT_HAS_SYNTH
void add_synth(CLI::App& app, int&) { add_left_out(app, "synth", "synthesis", "CUBOCT_SYNTH"); }
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
