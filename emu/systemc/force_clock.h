// SPDX-License-Identifier: MIT
// The cycles of a force engine, whatever its streamer walks: filter registers, queue, issue, pipes.
// docs/reference/node.md, "Force engine".
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "emu/machine/words.h"
#include "hw/plan/plan.h"

namespace cuboct::emu {

inline constexpr int kForceSegments =
    1 + kFaces;  // own, -x, +x, -y, +y, -z, +z; of a flat plan without -z, +z

struct ForceCounts {
  uint64_t candidates = 0;            // (record, pass) presented to the filter
  std::array<uint64_t, 3> by_axis{};  // of these, halo records, by the axis of their face
  uint64_t pairs_issued = 0;          // that passed the planar test
  uint64_t pairs_inside = 0;          // of these, nearer than the cutoff
  uint64_t stalls = 0;                // cycles in which a full queue held the streamer
  uint64_t issue_cycles = 0;          // cycles that issued a pair
  uint64_t entries = 0;               // pushed into the queue
  uint64_t tested = 0;                // halo records tested against the box of the own particles
  std::array<uint64_t, 3> culled{};   // of these, left out, by the axis of their face
  uint64_t busy = 0;                  // cycles from the engine's first to its last
};

// What the streamer presents in a step, in order, and the engine's queue.
struct ForceStream {
  std::vector<uint64_t> mask;                        // by entry: what the filter makes of it
  std::array<uint32_t, kForceSegments> segment_end;  // entries
  std::vector<uint32_t> queue;                       // a ring of entries
};

// Steps all cycles of one streamer and its pipes from cycle `begin` on, register by register; the last one.
// there(segment, entry): the cycle from which on the entry may be read; complete(segment): that from which on
// it is known that the segment has no further entry. `settle`: cycles after all but the pipes is empty,
// before which the last one does not come. `pipe`: from a pair's issue to its sum. issue(entry, mask) issues
// the lowest bits of `mask`, one per pipe, and clears them.
template <typename There, typename Complete, typename Issue>
uint64_t clock_stream(const Plan& plan, ForceStream& stream, int segments, uint64_t begin, There there,
                      Complete complete, int settle, int pipe, ForceCounts& counts, Issue issue) {
  const uint32_t depth = static_cast<uint32_t>(plan.arch.queue_depth);
  stream.queue.resize(depth);

  // The registers. `mask` of the filter's last and of `current` is that of their entry, less what was issued.
  int segment = 0;
  uint32_t next = 0;  // the streamer's entry
  constexpr uint32_t kNone = ~uint32_t{0};
  std::array<uint32_t, kFilterStages + 1> stages;  // F0, F1, ...: entries
  const std::span<uint32_t> filter(stages.data(), static_cast<size_t>(plan.latency.filter));
  stages.fill(kNone);
  int filtering = 0;  // of these, those that are not empty
  uint32_t current = 0;
  uint64_t current_mask = 0;
  uint32_t head = 0, count = 0;  // queue
  int hold = 0;                  // cycles until the next pair may be issued
  int drain = 0;                 // cycles until the last issued pair is in its sum

  // The next cycle in which the streamer may act.
  const auto from = [&] {
    return next < stream.segment_end[static_cast<size_t>(segment)] ? there(segment, next) : complete(segment);
  };
  uint64_t cycle = begin;
  for (;; ++cycle) {
    if (filtering == 0 && count == 0 && current_mask == 0 && hold == 0) {
      // Nothing moves but the pipes: on to where the streamer may go on, or the pipes are empty.
      if (segment == segments) {
        cycle += static_cast<uint64_t>(std::max(drain, settle));
        break;
      }
      if (const uint64_t acts = from(); acts > cycle) {
        drain = static_cast<int>(std::max<int64_t>(0, drain - static_cast<int64_t>(acts - cycle)));
        cycle = acts;
      }
    }
    const uint32_t held = count;  // at the start of the cycle
    if (hold > 0) {
      --hold;
      drain = std::max(0, drain - 1);
    } else if (current_mask != 0) {
      issue(current, current_mask);
      hold = plan.latency.interval - 1;
      ++counts.issue_cycles;
      // Issued in cycle t, in the sum from t + pipe on: the pipe is empty in cycle t + pipe, and this edge
      // ends cycle t.
      drain = pipe - 1;
    } else if (drain > 0) {
      --drain;
    }
    if (hold == 0 && current_mask == 0 && held > 0) {
      current = stream.queue[head];
      current_mask = stream.mask[current];
      head = head + 1 == depth ? 0 : head + 1;
      --count;
    }
    const uint32_t last = filter.back();
    if (last != kNone && stream.mask[last] != 0) {
      if (held == depth) {
        ++counts.stalls;
        continue;
      }
      const uint32_t tail = head + count;
      stream.queue[tail < depth ? tail : tail - depth] = last;
      ++count;
      ++counts.entries;
    }
    filtering -= last != kNone;
    std::move_backward(filter.begin(), filter.end() - 1, filter.end());
    filter[0] = kNone;
    if (segment == segments || from() > cycle) continue;
    const uint32_t end = stream.segment_end[static_cast<size_t>(segment)];
    if (next == end) {  // no record, or no slot to meet it
      ++segment;
      continue;
    }
    filter[0] = next++;
    ++filtering;
    ++counts.candidates;
    if (next == end && complete(segment) <= cycle) ++segment;
  }
  return cycle;
}

// The same of an engine with one streamer whose halos are read by phases. `available`: the cycle from which
// on the own cells, and the halos of each axis, may be read; the first is the engine's first cycle.
template <typename Issue>
uint64_t clock_force(const Plan& plan, ForceStream& stream, int segments,
                     const std::array<uint64_t, 4>& available, int pipe, ForceCounts& counts, Issue issue) {
  const auto from = [&](int segment) { return available[static_cast<size_t>(segment + 1) / 2]; };
  const uint64_t last = clock_stream(
      plan, stream, segments, available[0], [&](int segment, uint32_t) { return from(segment); }, from, 0,
      pipe, counts, issue);
  counts.busy += last - available[0] + 1;
  return last;
}

}  // namespace cuboct::emu
