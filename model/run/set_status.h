// SPDX-License-Identifier: MIT
// How far a study of macro-elements is: a line on a terminal, rewritten in place.
#pragma once

#include <string>

namespace cuboct {

class SetStatus {
 public:
  explicit SetStatus(std::string before = {});  // stands before the rest of the line
  ~SetStatus();
  SetStatus(const SetStatus&) = delete;
  SetStatus& operator=(const SetStatus&) = delete;
  // `set` from 0; part from 0 to 1.
  void say(size_t set, size_t sets, double part);

 private:
  std::string before_;
  bool shown_ = false;
};

}  // namespace cuboct
