// SPDX-License-Identifier: MIT
// What a command prints on stdout: lines for people as they come, or with --json one document and nothing
// else.
#pragma once

#include <fmt/format.h>

#include <string>

#include "cli/items.h"
#include "hw/program/options.h"
#include "model/base/error.h"

namespace cuboct {

struct Answer {
  bool json = false;

  void add_to(Command& command) {
    command.flag("--json", json, "print one JSON document instead of lines for people");
  }

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
