// SPDX-License-Identifier: MIT
// Where the keys of an input file stand, for refusals that come after the file was read.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace cuboct {

class Places {
 public:
  Places() = default;
  explicit Places(std::string file) : file_(std::move(file)) {}

  // `path` as in "run.duration"; of several tables of one name, the first. Line and column count from 1;
  // `excerpt` is that of the line (model/base/excerpt.h).
  void add(const std::string& path, int line, int column, std::string excerpt) {
    at_.try_emplace(path, Place{line, column, std::move(excerpt)});
  }

  bool has(const std::string& path) const { return at_.contains(path); }
  // Throws InputError at the first of `paths` that the file has; without a place where it has none.
  [[noreturn]] void fail(const std::vector<std::string>& paths, const std::string& message,
                         const std::string& hint = {}) const;

 private:
  struct Place {
    int line, column;
    std::string excerpt;
  };
  std::string file_;
  std::map<std::string, Place> at_;
};

}  // namespace cuboct
