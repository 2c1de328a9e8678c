// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace cuboct {

// A line on stderr with rate and time left: rewritten in place while stderr is a terminal; elsewhere nothing,
// or a line per second where `lines` is set.
class Progress {
 public:
  // `first`: the step at which this run begins, 0 unless it goes on with an earlier one.
  Progress(std::string label, uint64_t steps, uint64_t particles, uint64_t first = 0, bool lines = false);
  ~Progress();  // wipes the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void at(uint64_t step);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  uint64_t steps_, particles_, first_;
  bool terminal_, lines_, shown_ = false;
  Clock::time_point begin_, last_;
};

bool stderr_is_terminal();

}  // namespace cuboct
