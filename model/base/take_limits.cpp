// SPDX-License-Identifier: MIT
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "model/base/guarded_reader.h"
#include "model/base/sanitized.h"

namespace cuboct {
namespace {

// The soft limit: the hard one of processor time kills without a word of why.
void limit(__rlimit_resource what, rlim_t most) {
  rlimit now{};
  getrlimit(what, &now);
  now.rlim_cur = std::min(now.rlim_cur, most);  // RLIM_INFINITY is the largest
  setrlimit(what, &now);
}

}  // namespace

void take_limits(const ReaderLimits& limits) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.seconds);
  alarm(static_cast<unsigned>(10 * limits.seconds));
  if (!kSanitized) limit(RLIMIT_AS, limits.megabytes << 20);
}

}  // namespace cuboct
