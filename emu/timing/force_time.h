// SPDX-License-Identifier: MIT
// How long a node's force engine works: docs/reference/node.md, "Force engine", as a recurrence over the
// entries of its queue. docs/reference/timing.md derives it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cuboct::emu {

// Own, then the halos of faces -x, +x, -y, +y, -z, +z; a flat plan has the first five.
inline constexpr int kSegments = 7;

struct ForceShape {
  int queue_depth = 1;
  int pipe = 1;  // cycles from a pair's issue to its sum
  int axes = 3;
  int interval = 1;  // cycles from one issue to the next
  int read = 0;      // narrow memories: cycles to read a halo, its beats; 0: wide ones
};

// What the streamer walks. An item is a (record, pass); it becomes an entry of the queue if it has hits, and
// then takes ceil(hits / force_pipes) issues, one every `interval` cycles. A segment without items takes a
// cycle.
struct ForceWork {
  // An entry: its item, counted from the first segment's first, and its issues. At most 27 * 256 * 256 items,
  // 64 issues.
  static constexpr int kCycleBits = 7;
  static constexpr uint32_t entry(size_t item, uint32_t cycles) {
    return static_cast<uint32_t>(item) << kCycleBits | cycles;
  }

  std::array<uint32_t, kSegments> items{};  // by segment
  std::span<const uint32_t> entries;        // ascending
  uint64_t pairs = 0;                       // hits of all entries
};

// Cycle, counted from the engine's first, at which the halos of an axis may be read: [axis]. Not positive
// where that is so from the start.
using Available = std::array<int64_t, 3>;

struct ForceTime {
  int64_t last = 0;    // the engine's last cycle, counted from its first (0)
  int64_t stalls = 0;  // cycles in which a full queue, or with narrow memories a busy pipe, held the streamer
};

// `popped` is scratch, any content. With narrow memories a record's items, its passes, are the own particles.
ForceTime force_time(const ForceShape& shape, const ForceWork& work, const Available& available,
                     std::vector<int64_t>& popped);

// The same where there is no item: the segments are passed at cycles 0, max(1, x), ..., one after the
// other, and the engine ends a cycle after the last.
inline int64_t idle_force_time(const Available& available, int axes) {
  int64_t last = 1 + 2 * axes;
  for (int axis = 0; axis < axes; ++axis)
    if (const int64_t t = available[static_cast<size_t>(axis)] + 2 * (axes - axis); t > last) last = t;
  return last;
}

}  // namespace cuboct::emu
