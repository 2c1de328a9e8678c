// SPDX-License-Identifier: MIT
#include "hw/program/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <new>

#include "hw/program/options.h"
#include "model/base/resources.h"
#include "model/base/text.h"

namespace cuboct {

std::optional<int> parse_command_line(Command& app, int argc, char** argv) {
  try {
    const auto asked = app.parse(std::vector<std::string>(argv + std::min(argc, 1), argv + argc));
    if (!asked) return {};
    fmt::print("{}", *asked);
    return 0;
  } catch (const WrongWords& error) {
    fmt::print(stderr, "{}\nRun with --help for more information.\n", line_text(error.what()));
    return 2;
  }
}

std::optional<InputError> path_error(const std::exception& error) {
  const auto* refusal = dynamic_cast<const std::filesystem::filesystem_error*>(&error);
  if (refusal == nullptr) return {};
  return InputError(fmt::format("{}: {}", refusal->path1().string(), refusal->code().message()));
}

std::string failure_text(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) == nullptr) return block_text(error.what());
  return fmt::format("out of memory: {} are free now", in_bytes(static_cast<double>(free_memory())));
}

int run_command_line(Command& app, int argc, char** argv, const std::function<int()>& run) {
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
    fmt::print(stderr, "{}: {}\n", app.name(), failure_text(error));
    return 1;
  }
}

}  // namespace cuboct
