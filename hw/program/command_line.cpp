// SPDX-License-Identifier: MIT
#include "hw/program/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <sstream>

#include "model/base/text.h"

namespace cuboct {

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return {};
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, errors;
    const int code = app.exit(error, help, errors) == 0 ? 0 : 2;
    fmt::print("{}", help.str());
    fmt::print(stderr, "{}", block_text(errors.str()));
    return code;
  }
}

std::optional<InputError> path_error(const std::exception& error) {
  const auto* refusal = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
  if (refusal == nullptr) return {};
  return InputError(fmt::format("{}: {}", refusal->path1().string(), refusal->code().message()));
}

int run_command_line(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
  if (const std::optional<int> ended = parse_command_line(app, argc, argv)) return *ended;
  try {
    return run();
  } catch (const InputError& error) {
    fmt::print(stderr, "{}\n", error.told());
    return 2;
  } catch (const std::exception& error) {
    if (const auto refusal = path_error(error)) {
      fmt::print(stderr, "{}\n", refusal->told());
      return 2;
    }
    fmt::print(stderr, "{}: {}\n", app.get_name(), block_text(error.what()));
    return 1;
  }
}

}  // namespace cuboct
