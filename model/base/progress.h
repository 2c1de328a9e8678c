// SPDX-License-Identifier: MIT
// The progress of a run, on a terminal.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>

namespace cuboct {

// A line on stderr with rate and time left, rewritten in place; nothing where stderr is no terminal.
class Progress {
 public:
  // `particles`: of the rate; 0: without it. `shown` false: nothing on a terminal either.
  Progress(std::string label, uint64_t steps, uint64_t particles, bool shown = true);
  ~Progress() { wipe(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // The step at which the run begins, 0 unless it goes on with an earlier one.
  void begin(uint64_t step);
  void at(uint64_t step);
  void wipe();  // until the next at(): other lines can be printed

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  uint64_t steps_, particles_, first_ = 0;
  bool shown_, there_ = false;  // there_: on the terminal now
  Clock::time_point begin_, last_;
};

bool stderr_is_terminal();

}  // namespace cuboct
