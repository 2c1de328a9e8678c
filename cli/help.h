// SPDX-License-Identifier: MIT
// What --help prints: at most 80 columns; of each command what it does, its words, its options and an
// example.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "hw/program/options.h"

namespace cuboct {

std::string help_text(const CommandText& command);
// Its second line: "usage: cuboct run [OPTIONS] SCENE".
std::string usage_of(const CommandText& command);

// A row of the list of commands, in the order in which they are shown; commands of a group stand together.
struct HelpEntry {
  std::string_view group, command, example;
};
std::span<const HelpEntry> help_entries();

// "--out DIR", "-q, --quiet", or "SCENE"; and what help tells of it.
std::string option_names(const OptionText& option);
std::string option_text(const OptionText& option);

}  // namespace cuboct
