// SPDX-License-Identifier: MIT
// What a command prints on stdout: lines for people as they come, or with --json one document and nothing
// else.
#pragma once

#include <fmt/format.h>

#include <string>

#include "cli/items.h"
#include "model/base/error.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cuboct {

struct Answer {
  bool json = false;

  CLI::Option* add_to(CLI::App& command);  // --json

  // For people alone.
  template <typename... Args>
  void say(fmt::format_string<Args...> format, Args&&... args) const {
    if (!json) fmt::print(format, std::forward<Args>(args)...);
  }
  // The end, for scripts alone; `document` is JSON.
  void close(const std::string& document) const {
    if (json) fmt::print("{}\n", document);
  }
  // The end, for both.
  void close(const Items& items) const { fmt::print("{}", json ? items.json() : items.text()); }
};

// A command that failed without anything wrong in its input: exit code 1.
class Failed : public std::exception {
 public:
  explicit Failed(const std::string& message, const std::string& hint = {}) : error(message, hint) {}
  const char* what() const noexcept override { return error.what(); }
  InputError error;
};

}  // namespace cuboct
