// SPDX-License-Identifier: MIT
// The command line of `cuboct` and of the programs beside it, which all know every command.
#pragma once

#include <span>
#include <string_view>

namespace cuboct {

class Command;

struct OwnCommand {
  std::string_view name;
  void (*add)(Command& app, int& exit_code);
};

// What the main of such a program returns. A command that is not one of `own` is its program's: the process
// becomes that one (execv), so its streams, signals and exit code are the command's.
int front(int argc, char** argv, std::span<const OwnCommand> own);

}  // namespace cuboct
