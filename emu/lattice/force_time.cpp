// SPDX-License-Identifier: MIT
#include "emu/lattice/force_time.h"

#include <algorithm>

namespace cuboct::emu {
namespace {

// Long before the engine's first cycle.
constexpr int64_t kNever = INT64_MIN / 4;

}  // namespace

int64_t force_time(const ForceShape& shape, const ForceWork& work, const Available& available,
                   std::vector<int64_t>& popped) {
  const auto depth = static_cast<size_t>(shape.queue_depth);
  size_t items = 0;
  for (const int count : work.items) items += static_cast<size_t>(count);
  if (popped.size() < items + depth + 1) popped.resize(items + depth + 1);
  // pop[j] is the cycle at which entry j - Q leaves the queue for `current`; the first Q pushes wait for none.
  int64_t* pop = popped.data();
  std::fill(pop, pop + depth, kNever);

  int64_t left = 1;              // cycle in which the item before left F1
  int64_t next = 0;              // cycle in which the streamer may present again
  int64_t free = kNever;         // cycle of the last issue so far: a new entry may move to `current` in it
  int64_t streamed = 0;          // cycle of the last presentation
  int64_t filtered = kNever;     // cycle in which the last real item left F1
  const uint8_t* service = work.service;
  for (int segment = 0; segment < kSegments; ++segment) {
    const int64_t from = segment == 0 ? 0 : available[static_cast<size_t>(segment - 1) / 2];
    streamed = next;
    if (from > next) {
      // Bubbles follow the item before through F0 and F1.
      streamed = std::max(from, left);
      left = streamed + 1;
    }
    next = left;
    const int count = work.items[static_cast<size_t>(segment)];
    if (count == 0) {
      ++left;
      continue;
    }
    for (const uint8_t* const end = service + count; service != end; ++service) {
      const int64_t cycles = *service;
      next = left;
      const int64_t room = cycles != 0 ? pop[0] : kNever;
      left = std::max(left, room) + 1;
      const int64_t moved = std::max(free, left + 1);
      pop[depth] = moved;
      pop += cycles != 0;
      free = cycles != 0 ? moved + cycles : free;
    }
    filtered = left;
  }
  return std::max({streamed + 1, filtered + 1, free + shape.pipe});
}

}  // namespace cuboct::emu
