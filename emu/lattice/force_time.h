// SPDX-License-Identifier: MIT
// How long a node's force engine works: docs/reference/node.md, "Force engine", as recurrences over the
// streamer's items. Derivation in docs/reference/timing.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cuboct::emu {

inline constexpr int kSegments = 7;  // own, then the halos of faces -x, +x, -y, +y, -z, +z

struct ForceShape {
  int queue_depth = 1;
  int pipe = 1;  // cycles from a pair's issue to its sum
};

// What the streamer walks: an item is a (record, pass), and its service the cycles that its hits take in the
// pipes, ceil(hits / force_pipes). A segment without items takes a cycle.
struct ForceWork {
  std::array<int, kSegments> items{};  // by segment
  const uint8_t* service = nullptr;    // by item, segments one after the other
};

// Cycle, counted from the engine's first, at which the halos of an axis may be read: [axis]. Not positive where
// that is so from the start.
using Available = std::array<int64_t, 3>;

// The engine's last cycle, counted from its first (0). `popped` is scratch, any content.
int64_t force_time(const ForceShape& shape, const ForceWork& work, const Available& available,
                   std::vector<int64_t>& popped);

// The same where there is no item.
inline int64_t idle_force_time(const Available& available) {
  // Seven segments, a cycle each, are passed at cycles 0, max(1, x), ...; the engine ends a cycle after the last.
  int64_t last = 7;
  for (int axis = 0; axis < 3; ++axis)
    if (const int64_t t = available[static_cast<size_t>(axis)] + 6 - 2 * axis; t > last) last = t;
  return last;
}

}  // namespace cuboct::emu
