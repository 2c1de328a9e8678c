// SPDX-License-Identifier: MIT
// Processor time of a thread.
#pragma once

#include <ctime>

namespace cuboct::study {

// s of a core that the calling thread has used.
inline double thread_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace cuboct::study
