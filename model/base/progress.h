// SPDX-License-Identifier: MIT
// The progress of a run, on a terminal.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>

namespace cuboct {

bool stderr_is_terminal();

// A line on stderr, rewritten in place; nothing where stderr is no terminal.
class StatusLine {
 public:
  StatusLine() = default;
  ~StatusLine() { wipe(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void say(const std::string& text);
  void wipe();  // other lines can be printed

 private:
  bool there_ = false;
};

// Such a line with rate and time left.
class Progress {
 public:
  // `particles`: of the rate; 0: without it. `shown` false: nothing on a terminal either.
  Progress(std::string label, uint64_t steps, uint64_t particles, bool shown = true);

  // The step at which the run begins, 0 unless it goes on with an earlier one.
  void begin(uint64_t step);
  void at(uint64_t step);
  void wipe() { line_.wipe(); }  // until the next at()

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  uint64_t steps_, particles_, first_ = 0;
  bool shown_;
  StatusLine line_;
  Clock::time_point begin_, last_;
};

}  // namespace cuboct
