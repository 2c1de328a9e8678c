// SPDX-License-Identifier: MIT
#include "emu/timing/force_time.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "emu/timing/cycles.h"
#include "hw/plan/plan.h"

namespace cuboct::emu {
namespace {

// One candidate after the other: read, then walked past the slots.
ForceTime walk_time(const ForceShape& shape, const ForceWork& work) {
  const uint32_t* entry = work.entries.data();
  const uint32_t* const last_entry = entry + work.entries.size();
  const int64_t own = std::lround(std::sqrt(work.items[0]));
  int64_t cycle = 0, ready = 0, empty = 0, stalls = 0;
  int64_t item = 0;
  const size_t segments = 1 + 2 * static_cast<size_t>(shape.axes);
  for (size_t segment = 0; segment < segments; ++segment) {
    if (work.items[segment] == 0) ++cycle;
    for (const int64_t end = item + work.items[segment]; item < end; item += own) {
      cycle += 1 + (segment == 0 ? 1 : shape.read);
      // `result` is the cycle in which R holds `slot`; `tested`: T holds the next one then.
      int64_t slot = 0, result = cycle + 1;
      bool tested = true;
      const auto go_on = [&](int64_t to) {  // no hit from `slot` on until `to`
        if (to == slot) return;
        result += to - slot + (tested ? 0 : 1);
        slot = to;
        tested = true;
      };
      for (; entry != last_entry && *entry >> ForceWork::kCycleBits < item + own; ++entry) {
        go_on((*entry >> ForceWork::kCycleBits) - item);
        const int64_t issued = std::max(result, ready);
        stalls += issued - result;
        ready = issued + shape.interval;
        empty = issued + shape.pipe;
        // The next slot follows at once where T held it; else it is asked for anew.
        result = issued + (tested ? 1 : 3);
        tested = !tested;
        ++slot;
      }
      if (slot < own) {
        go_on(own - 1);
        ++slot, ++result;
      } else {
        // The last slot was a hit: the next candidate follows its issue.
        result = ready - shape.interval + 1;
      }
      cycle = result;
    }
  }
  return {std::max(cycle, empty), stalls};
}

}  // namespace

ForceTime force_time(const ForceShape& shape, const ForceWork& work, const Available& available,
                     std::vector<int64_t>& popped) {
  if (shape.read > 0) return walk_time(shape, work);
  const auto depth = static_cast<size_t>(shape.queue_depth);
  const int64_t interval = shape.interval;
  const size_t entries = work.entries.size();
  if (popped.size() < entries + depth) popped.resize(entries + depth);
  // pop[0] is the cycle at which the entry Q before the next one leaves the queue; the first Q wait for none.
  int64_t* pop = popped.data();
  std::fill(pop, pop + depth, kLongAgo);

  // The streamer's positions are its items and the cycles in which it presents nothing. All registers of the
  // filter move together, so that it acts again when the position kFilterStages before leaves them: the
  // cycles in which the last so many do, the oldest first.
  std::array<int64_t, kFilterStages> leaves;
  for (size_t k = 0; k < leaves.size(); ++k) leaves[k] = static_cast<int64_t>(k);
  const auto leave = [&](int64_t cycle) {
    std::copy(leaves.begin() + 1, leaves.end(), leaves.begin());
    leaves.back() = cycle;
  };
  int64_t issued =
      kLongAgo;          // last cycle that the entries so far keep `current`: the next may move there in it
  int64_t streamed = 0;  // cycle of the last presentation
  int64_t filtered = kLongAgo;  // cycle in which the last item leaves the filter
  int64_t stalls = 0;
  const uint32_t* entry = work.entries.data();
  const uint32_t* const last_entry = entry + entries;
  int64_t first_item = 0;
  const size_t segments = 1 + 2 * static_cast<size_t>(shape.axes);
  for (size_t segment = 0; segment < segments; ++segment) {
    const int64_t from = segment == 0 ? 0 : available[(segment - 1) / 2];
    // Nothing is presented until then. Once the filter holds nothing else, one leaves it in each cycle.
    for (int k = 0; k < kFilterStages && from > leaves.front(); ++k) leave(leaves.back() + 1);
    if (const int64_t wait = from - leaves.front(); wait > 0)
      for (int64_t& cycle : leaves) cycle += wait;
    streamed = leaves.front();
    const uint32_t count = work.items[segment];
    if (count == 0) {
      leave(leaves.back() + 1);
      continue;
    }
    // Item k leaves in cycle base + k, unless an entry waits for room: then base grows from that item on.
    const int64_t end_item = first_item + count;
    int64_t base = leaves.back() + 1 - first_item, left = first_item;
    const auto leave_until = [&](int64_t item) {
      for (left = std::max(left, item - kFilterStages); left < item; ++left) leave(base + left);
    };
    for (; entry != last_entry && *entry >> ForceWork::kCycleBits < end_item; ++entry) {
      const int64_t item = *entry >> ForceWork::kCycleBits,
                    cycles = (*entry & ((1 << ForceWork::kCycleBits) - 1)) * interval;
      if (const int64_t room = *pop + 1 - item; room > base) {
        leave_until(item);
        stalls += room - base;
        base = room;
      }
      const int64_t moved = std::max(issued, base + item + 1);
      pop[depth] = moved;
      ++pop;
      issued = moved + cycles;
    }
    leave_until(end_item);
    filtered = leaves.back();
    first_item = end_item;
  }
  return {std::max({streamed + 1, filtered + 1, issued - (interval - 1) + shape.pipe}), stalls};
}

}  // namespace cuboct::emu
