// SPDX-License-Identifier: MIT
#include "model/run/set_status.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "model/base/progress.h"

namespace cuboct {

SetStatus::SetStatus(std::string before) : before_(std::move(before)) {}

SetStatus::~SetStatus() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void SetStatus::say(size_t set, size_t sets, double part) {
  if (!stderr_is_terminal()) return;
  fmt::print(stderr, "\r\x1b[K{}set {} of {}: {:.0f} %", before_, set + 1, sets, 100 * part);
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace cuboct
