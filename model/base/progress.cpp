// SPDX-License-Identifier: MIT
#include "model/base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace cuboct {

bool stderr_is_terminal() { return isatty(STDERR_FILENO) != 0; }

Progress::Progress(std::string label, uint64_t steps, uint64_t particles, uint64_t first, bool lines)
    : label_(std::move(label)),
      steps_(steps),
      particles_(particles),
      first_(first),
      terminal_(stderr_is_terminal()),
      lines_(lines),
      begin_(Clock::now()),
      last_(begin_) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::at(uint64_t step) {
  if (!terminal_ && !lines_) return;
  const auto now = Clock::now();
  if (now - last_ < std::chrono::milliseconds(terminal_ ? 200 : 1000)) return;
  last_ = now;
  shown_ = terminal_;
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const double rate = static_cast<double>(step - first_) / seconds;
  const auto left = rate > 0 ? static_cast<uint64_t>(static_cast<double>(steps_ - step) / rate) : 0;
  fmt::print(stderr, "{}{}: step {} of {} ({} %), {:.3g} particle-steps/s, {}:{:02} left{}",
             terminal_ ? "\r\x1b[K" : "", label_, step, steps_, steps_ > 0 ? step * 100 / steps_ : 100,
             rate * static_cast<double>(particles_), left / 60, left % 60, terminal_ ? "" : "\n");
  std::fflush(stderr);
}

}  // namespace cuboct
