// SPDX-License-Identifier: MIT
#include "hw/cycles.h"

#include <algorithm>
#include <array>
#include <vector>

namespace cuboct {
namespace {

uint64_t ceil_div(uint64_t a, uint64_t b) { return (a + b - 1) / b; }

// From the load of an end beat to the cycle in which the receiver's phase can end: output register,
// receiver's register.
constexpr uint64_t kEndBeat = 2;

// Records that a node sends in each exchange, and the empty segments that it passes, a cycle each.
struct Sends {
  std::array<uint64_t, 3> records{}, empty{};
};

}  // namespace

ExpectedCycles expected_cycles(const Plan& plan, const State& state) {
  const Lattice& lattice = plan.lattice;
  const int axes = plan.rule.axes;
  std::vector<std::array<uint64_t, 7>> segment(lattice.size());  // particles: own, then the halos by face
  std::vector<Sends> sends(lattice.size());
  std::vector<std::vector<const Particle*>> nodes(lattice.size());
  for (const Particle& p : state.particles) nodes[p.node].push_back(&p);
  for (uint32_t n = 0; n < lattice.size(); ++n) segment[n][0] = nodes[n].size();
  for (int axis = 0; axis < axes; ++axis) {
    for (uint32_t n = 0; n < lattice.size(); ++n)
      for (int s = 0; s < 1 + 2 * axis; ++s) {
        sends[n].records[axis] += segment[n][s];
        sends[n].empty[axis] += segment[n][s] == 0;
      }
    for (uint32_t n = 0; n < lattice.size(); ++n)
      for (int face = 2 * axis; face < 2 * axis + 2; ++face)
        if (lattice.neighbour(n, face) != kNoNode)
          segment[n][1 + face] = sends[lattice.neighbour(n, face)].records[axis];
  }

  const auto beats = static_cast<uint64_t>(plan.words.halo_beats);
  const uint64_t end_beat = kEndBeat + static_cast<uint64_t>(plan.link.latency);
  // A migrate phase in which nothing moves: end beats, their way, one cycle to leave each face's FIFO.
  const uint64_t quiet_migrate = 1 + end_beat + 2;
  const auto send_time = [&](uint32_t n, int axis) {
    return sends[n].records[axis] * beats + sends[n].empty[axis] + 1;
  };
  ExpectedCycles expected;
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    const uint64_t own = segment[n][0];
    const uint64_t passes = ceil_div(own, static_cast<uint64_t>(plan.arch.filter_lanes));
    std::array<uint64_t, 3> exchanged{};  // the cycle at which each exchange is over
    uint64_t now = 0;
    for (int axis = 0; axis < axes; ++axis) {
      uint64_t longest = send_time(n, axis);
      for (int face = 2 * axis; face < 2 * axis + 2; ++face)
        if (lattice.neighbour(n, face) != kNoNode)
          longest = std::max(longest, send_time(lattice.neighbour(n, face), axis));
      exchanged[axis] = now += longest + end_beat;
    }
    uint64_t streamed = plan.arch.overlap ? 0 : now;
    uint64_t candidates = 0;
    for (int s = 0; s < 1 + 2 * axes; ++s) {
      if (s > 0 && plan.arch.overlap) streamed = std::max(streamed, exchanged[(s - 1) / 2]);
      const uint64_t work = segment[n][s] * passes;
      streamed += std::max<uint64_t>(work, 1);
      candidates += work;
    }
    // With narrow memories a candidate's words are read, then it meets one slot after the other, and waits for the
    // pipe where it has hits.
    const bool narrow = plan.arch.narrow_memories;
    const auto interval = static_cast<uint64_t>(plan.latency.interval);
    uint64_t pairs = 0, walk = 0, ready = 0;
    if (own > 0)
      for (const auto& [other, offset] : lattice.neighbourhood(n))
        for (const Particle* j : nodes[other])
          for (const Particle* i : nodes[n]) {
            if (narrow) walk += i == nodes[n].front() ? 3 + (other == n ? 1 : beats) : 1;
            Int3 x_j;
            for (int a = 0; a < 3; ++a)
              x_j[a] = j->x[a] + (int64_t{offset[a]} << plan.rule.widths.position_frac);
            const bool hit = i != j && may_interact(plan.rule, i->x, x_j);
            pairs += hit;
            if (!narrow || !hit) continue;
            walk = std::max(walk + 1, ready);
            ready = walk + interval;
          }
    if (narrow) streamed = std::max(streamed, now + walk);
    const uint64_t issues = ceil_div(pairs, static_cast<uint64_t>(plan.arch.force_pipes)) *
                            static_cast<uint64_t>(plan.latency.interval);
    const uint64_t busy = std::max(candidates, issues);
    expected.ideal = std::max(expected.ideal, busy);
    // The last candidate's pairs pass F1, the queue and `current`, then the pipe.
    const uint64_t force = std::max(streamed + static_cast<uint64_t>(plan.latency.filter), issues) +
                           (own > 0 ? 2 + static_cast<uint64_t>(plan.latency.pipe) : 0);
    const uint64_t update = own > 0 ? (own - 1) * static_cast<uint64_t>(plan.latency.stride) +
                                          static_cast<uint64_t>(plan.latency.update)
                                    : 1;
    expected.step = std::max(expected.step, force + update + static_cast<uint64_t>(axes) * quiet_migrate);
  }
  return expected;
}

}  // namespace cuboct
