// SPDX-License-Identifier: MIT
#include "model/base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace cuboct {

bool stderr_is_terminal() { return isatty(STDERR_FILENO) != 0; }

void StatusLine::say(const std::string& text) {
  if (!stderr_is_terminal()) return;
  fmt::print(stderr, "\r\x1b[K{}", text);
  std::fflush(stderr);
  there_ = true;
}

void StatusLine::wipe() {
  if (there_) fmt::print(stderr, "\r\x1b[K"), std::fflush(stderr);
  there_ = false;
}

Progress::Progress(std::string label, uint64_t steps, uint64_t particles, bool shown)
    : label_(std::move(label)),
      steps_(steps),
      particles_(particles),
      shown_(shown && stderr_is_terminal()),
      begin_(Clock::now()),
      last_(begin_) {}

void Progress::begin(uint64_t step) {
  first_ = step;
  begin_ = last_ = Clock::now();
}

void Progress::at(uint64_t step) {
  if (!shown_) return;
  const auto now = Clock::now();
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const double rate = static_cast<double>(step - first_) / seconds;
  const auto left = rate > 0 ? static_cast<uint64_t>(static_cast<double>(steps_ - step) / rate) : 0;
  const std::string speed =
      particles_ > 0 ? fmt::format("{:.3g} particle-steps/s, ", rate * static_cast<double>(particles_)) : "";
  line_.say(fmt::format("{}: step {} of {} ({} %), {}{}:{:02} left", label_, step, steps_,
                        steps_ > 0 ? step * 100 / steps_ : 100, speed, left / 60, left % 60));
}

}  // namespace cuboct
