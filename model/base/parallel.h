// SPDX-License-Identifier: MIT
// Loops over independent parts, in threads that wait without taking the cores from other programs.
//
// Each calling thread has a team of helpers, which live as long as it does. A part that its own thread has
// not begun is taken by one that is free, the caller among them: a helper that the system keeps from running
// delays nothing but the part it is in. Who waits spins for tens of microseconds, the length of the work
// between two loops, then sleeps.
#pragma once

#include <algorithm>
#include <cstddef>

#include "model/base/resources.h"

namespace cuboct {

using PartCall = void (*)(const void* work, size_t part, int member);
void call_for_each_part(size_t parts, int threads, PartCall call, const void* work);

// Calls work(part, member) once for each part in [0, parts). member < threads tells the threads at work
// apart, and is 0 in the calling one. Of what `work` throws, the first is thrown again behind the loop. What
// it makes must not depend on who does which part.
template <typename Work>
void for_each_part(size_t parts, int threads, const Work& work) {
  if (threads < 2 || parts < 2) {
    for (size_t part = 0; part < parts; ++part) work(part, 0);
    return;
  }
  call_for_each_part(
      parts, threads,
      [](const void* context, size_t part, int member) {
        (*static_cast<const Work*>(context))(part, member);
      },
      &work);
}

// Calls work(begin, end) for ranges that together are [0, count), in up to `most` threads, or one per core
// (0); here alone where there are fewer than `least` for a second thread.
template <typename Work>
void for_each_range(size_t count, size_t least, const Work& work, int most = 0) {
  const int threads = most > 0 ? most : usable_cores();
  const size_t parts = std::clamp<size_t>(count / least, 1, static_cast<size_t>(threads));
  for_each_part(parts, threads,
                [&](size_t part, int) { work(count * part / parts, count * (part + 1) / parts); });
}

}  // namespace cuboct
