// SPDX-License-Identifier: MIT
// The commands of `cuboct`, the program that has each, and what a build can be without.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cuboct {

class Command;

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

}  // namespace cuboct
