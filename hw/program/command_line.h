// SPDX-License-Identifier: MIT
// A program's command line: it is parsed, the program runs, and errors become text and exit codes.
#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <string>

#include "model/base/error.h"

namespace cuboct {

class Command;

// Nothing where the words are right; else help on standard output and 0, or the error on standard error and
// 2.
std::optional<int> parse_command_line(Command& app, int argc, char** argv);

// The same error as one of input, where it is the file system's refusal of a path that was asked for.
std::optional<InputError> path_error(const std::exception& error);

// What an exception that is no refusal says, on lines of its own; of memory that is not there, how much is.
std::string failure_text(const std::exception& error);

// What `run` returns; 2 for an InputError, 1 for another exception. The name of the app stands before the
// latter's text.
int run_command_line(Command& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace cuboct
