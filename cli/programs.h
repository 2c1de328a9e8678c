// SPDX-License-Identifier: MIT
// The commands of `cuboct`, the program that has each, and what a build can be without.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "hw/program/options.h"

namespace cuboct {

// CMake says what is built (cli/CMakeLists.txt).
struct BuildPart {
  std::string_view name;  // completes "built without ..."
  std::string_view cure;  // the hint beside it
  bool built;
};
extern const BuildPart kStudies, kFits, kBondFits, kLearning, kSynthesis, kView;

// `asked`: the words that ask for it, as "emit --fit".
[[noreturn]] void refuse_left_out(const std::string& asked, const BuildPart& part);

struct CommandRow {
  std::string_view name, about;  // about: what help tells of it
  std::string_view program;  // libraries that a run does not need are those of another program than cuboct
  const BuildPart* part;     // that brings it; null: it is in every build
};
// In the order in which errors list them.
std::span<const CommandRow> command_rows();

// A command of this program, with what its row says of it.
Command add_command(Command& app, std::string_view name);
// The same with its options, with which it calls `run`: what that returns is the exit code, if it does.
template <class Options, class Run>
std::pair<Command, std::shared_ptr<Options>> add_command(Command& app, std::string_view name, int& exit_code,
                                                         Run run) {
  Command command = add_command(app, name);
  auto options = std::make_shared<Options>();
  if constexpr (std::is_void_v<decltype(run(*options))>)
    command.callback([options, run] { run(*options); });
  else
    command.callback([options, run, &exit_code] { exit_code = run(*options); });
  return {command, options};
}

}  // namespace cuboct
