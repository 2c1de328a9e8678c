// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace cuboct {

// A line on stderr with rate and time left, while stderr is a terminal; nothing otherwise.
class Progress {
 public:
  Progress(std::string label, uint64_t steps, uint64_t particles);
  ~Progress();  // wipes the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void at(uint64_t step);

 private:
  using Clock = std::chrono::steady_clock;
  std::string label_;
  uint64_t steps_, particles_;
  bool terminal_, shown_ = false;
  Clock::time_point begin_, last_;
};

bool stderr_is_terminal();

}  // namespace cuboct
