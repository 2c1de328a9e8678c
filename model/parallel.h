// SPDX-License-Identifier: MIT
// Loops over millions of independent things, in threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace cuboct {

// Calls work(begin, end) for ranges that together are [0, count), each in a thread of its own: `most`, or
// one per core (0); here alone where there are fewer than `least` for a second thread. `work` must not throw, and what it makes
// must not depend on where the ranges part.
template <typename Work>
void for_each_range(size_t count, size_t least, Work work, int most = 0) {
  const size_t cores = std::max(1u, std::thread::hardware_concurrency());
  const size_t parts = std::clamp<size_t>(count / least, 1, most > 0 ? static_cast<size_t>(most) : cores);
  std::vector<std::thread> threads;
  for (size_t part = 1; part < parts; ++part)
    threads.emplace_back(work, count * part / parts, count * (part + 1) / parts);
  work(size_t{0}, count / parts);
  for (std::thread& thread : threads) thread.join();
}

}  // namespace cuboct
