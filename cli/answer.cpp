// SPDX-License-Identifier: MIT
#include "cli/answer.h"

#include <CLI/CLI.hpp>

namespace cuboct {

CLI::Option* Answer::add_to(CLI::App& command) {
  return command.add_flag("--json", json, "print one JSON document instead of lines for people");
}

}  // namespace cuboct
