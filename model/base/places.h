// SPDX-License-Identifier: MIT
// Where the keys of an input file stand, for refusals that come after the file was read.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/base/error.h"

namespace cuboct {

class Places {
 public:
  Places() = default;
  explicit Places(std::string file) : file_(std::move(file)) {}

  // `path` as in "run.duration"; of several tables of one name the first, unless it says which:
  // "constraint[grip].velocity", "bond[steel,glue]". Line and column count from 1; `excerpt` is that of the
  // line (model/base/excerpt.h).
  void add(const std::string& path, int line, int column, std::string excerpt) {
    at_.try_emplace(path, Place{line, column, std::move(excerpt)});
  }
  // From now on a key that [[stage]] `name` has too means that one.
  void prefer_stage(const std::string& name) { stage_ = "stage[" + name + "]."; }

  // Throws InputError at the first of `paths` that the file has; without a place where it has none.
  [[noreturn]] void fail(const std::vector<std::string>& paths, const std::string& message,
                         const std::string& hint = {}) const;
  // The error at the first of its keys that the file has; as it was where it has none, or a place already.
  InputError placed(const InputError& error) const;

 private:
  struct Place {
    int line, column;
    std::string excerpt;
  };
  const Place* find(const std::vector<std::string>& paths) const;

  std::string file_, stage_;
  std::map<std::string, Place> at_;
};

}  // namespace cuboct
