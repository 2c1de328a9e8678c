// SPDX-License-Identifier: MIT
#include "hw/cost/cycles.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "model/base/integer_math.h"
#include "model/program/integer_program.h"

namespace cuboct {
namespace {

// From the load of an end beat to the cycle in which the receiver's phase can end: output register,
// receiver's register.
constexpr uint64_t kEndBeat = 2;

// Records that a node sends in each exchange, its segments, and those that are empty, which take a cycle
// each.
struct Sends {
  std::array<uint64_t, 3> records{}, segments{}, empty{};
};

// Nodes that serve bricks: the same way through their phases.
class BrickCycles {
 public:
  BrickCycles(const Plan& plan, const PairCensus& census)
      : plan_(plan), map_(plan.lattice, plan.bricks, plan.rule.axes), census_(census) {}
  ExpectedCycles expected() const {
    ExpectedCycles expected;
    for (uint32_t n = 0; n < plan_.nodes(); ++n) add(n, expected);
    return expected;
  }

 private:
  uint64_t held(uint32_t n, uint32_t place) const {
    const uint32_t cell = map_.cell(n, place);
    return cell == kNoCell ? 0 : census_.particles(cell);
  }
  // Cycles, from the start of an exchange, after which the end beat that goes over `face` has been loaded.
  uint64_t sent(uint32_t n, int face) const {
    const auto layer = [&](int f) {
      uint64_t cycles = 1;
      if (plan_.neighbour(n, f) != kNoNode)
        for (const BrickWalk::Sent& s : map_.walk(n).sent[static_cast<size_t>(f)])
          cycles += std::max<uint64_t>(held(n, s.grid) * static_cast<uint64_t>(plan_.words.halo_beats), 1);
      return cycles;
    };
    const bool second = face % 2 == 1 && plan_.bricks.shape()[face / 2] > 1;
    return second ? layer(face - 1) + layer(face) : layer(face);
  }
  void add(uint32_t n, ExpectedCycles& expected) const;

  const Plan& plan_;
  const BrickMap map_;
  const PairCensus& census_;
};

void BrickCycles::add(uint32_t n, ExpectedCycles& expected) const {
  const int axes = plan_.rule.axes;
  const BrickWalk& walk = map_.walk(n);
  const uint64_t end_beat = kEndBeat + static_cast<uint64_t>(plan_.link.latency);
  std::array<uint64_t, 3> exchanged{};
  uint64_t now = 0;
  for (int axis = 0; axis < axes; ++axis) {
    uint64_t longest = sent(n, 2 * axis + 1) + 1;
    for (int face = 2 * axis; face < 2 * axis + 2; ++face)
      if (const uint32_t near = plan_.neighbour(n, face); near != kNoNode)
        longest = std::max(longest, sent(near, face ^ 1) + end_beat);
    exchanged[static_cast<size_t>(axis)] = now += longest;
  }
  uint64_t streamed = plan_.arch.overlap ? 0 : now, candidates = 0, met = 0, own = 0, slots = 0;
  for (const uint32_t local : walk.own) {
    const uint32_t cell = plan_.cell_of(n, local);
    const uint64_t count = cell == kNoCell ? 0 : census_.particles(cell);
    own += count;
    slots += std::max<uint64_t>(count, 1);
  }
  for (size_t s = 0; s < 1 + 2 * static_cast<size_t>(axes); ++s) {
    if (s > 0 && plan_.arch.overlap) streamed = std::max(streamed, exchanged[(s - 1) / 2]);
    uint64_t items = 0;
    for (const BrickWalk::Visit& visit : walk.visits[s]) {
      const uint32_t cell = plan_.cell_of(n, visit.own);
      const uint64_t passes =
          cell == kNoCell ? 0
                          : ceil_div(census_.particles(cell), static_cast<uint64_t>(plan_.arch.filter_lanes));
      items += passes == 0;
      if (passes == 0) continue;
      for (uint32_t k = visit.first; k < visit.end; ++k) {
        const uint64_t work = held(n, walk.near[k].grid) * passes;
        items += std::max<uint64_t>(work, 1);
        candidates += work;
        if (work > 0) met += census_.pairs(cell, walk.near[k].offset);
      }
    }
    streamed += std::max<uint64_t>(items, 1);
  }
  const uint64_t issues = ceil_div(met, static_cast<uint64_t>(plan_.arch.force_pipes)) *
                          static_cast<uint64_t>(plan_.latency.interval);
  expected.ideal = std::max(expected.ideal, std::max(candidates, issues));
  const uint64_t force = std::max(streamed + static_cast<uint64_t>(plan_.latency.filter), issues) +
                         (own > 0 ? 2 + static_cast<uint64_t>(plan_.latency.pipe) : 0);
  const uint64_t update = own > 0 ? slots - 1 + static_cast<uint64_t>(plan_.latency.update) : 1;
  expected.step = std::max(expected.step, force + update + static_cast<uint64_t>(axes) * (1 + end_beat));
}

Int3 moved(const FixedRule& rule, const Particle& j, const Cell& offset) {
  Int3 x = visible(rule, j.x);
  for (int a = 0; a < 3; ++a) x[a] += int64_t{offset[a]} << rule.widths.position_frac;
  return x;
}

using Held = std::vector<std::vector<const Particle*>>;  // by cell

Held held_by(const Lattice& lattice, const State& state) {
  Held held(lattice.size());
  for (const Particle& p : state.particles) held[p.cell].push_back(&p);
  return held;
}

uint32_t count_pairs(const FixedRule& rule, const std::vector<const Particle*>& own,
                     const std::vector<const Particle*>& near, const Cell& offset) {
  uint32_t count = 0;
  for (const Particle* j : near) {
    const Int3 x_j = moved(rule, *j, offset);
    for (const Particle* i : own) count += i != j && may_interact(rule, visible(rule, i->x), x_j);
  }
  return count;
}

// To particles of the cell `near`, which is met over one way alone: rings have three cells at least.
uint32_t count_bonds(const graph::BondRows& rows, const std::vector<const Particle*>& own,
                     const std::vector<uint32_t>& cell_of, uint32_t near) {
  uint32_t count = 0;
  for (const Particle* i : own)
    for (uint64_t b = rows.first[i->id]; b < rows.first[i->id + 1]; ++b)
      count += cell_of[rows.other[b]] == near;
  return count;
}

// Cycles that a node with narrow memories takes to bring its candidates and walk its slots: a candidate's
// words are read, then it meets one slot after the other, and waits for the pipe where it has hits.
uint64_t narrow_walk(const Plan& plan, const Held& held, uint32_t n) {
  const auto beats = static_cast<uint64_t>(plan.words.halo_beats);
  const auto interval = static_cast<uint64_t>(plan.latency.interval);
  uint64_t walk = 0, ready = 0;
  for (const auto& [other, offset] : plan.lattice.neighbourhood(n))
    for (const Particle* j : held[other]) {
      if (!held[n].empty()) walk += 3 + (other == n ? 1 : beats);
      for (const Particle* i : held[n]) {
        if (i != held[n].front()) ++walk;
        if (i == j || !may_interact(plan.rule, visible(plan.rule, i->x), moved(plan.rule, *j, offset)))
          continue;
        walk = std::max(walk + 1, ready);
        ready = walk + interval;
      }
    }
  return walk;
}

// Nodes of one cell. particles(n); pairs(n): with all cells around; walk(n): narrow_walk, or 0.
template <typename Particles, typename Pairs, typename Walk>
ExpectedCycles single_cycles(const Plan& plan, Particles particles, Pairs pairs_of, Walk walk) {
  const Lattice& lattice = plan.lattice;
  const int axes = plan.rule.axes;
  std::vector<std::array<uint64_t, 7>> segment(lattice.size());  // particles: own, then the halos by face
  std::vector<Sends> sends(lattice.size());
  for (uint32_t n = 0; n < lattice.size(); ++n) segment[n][0] = particles(n);
  for (int axis = 0; axis < axes; ++axis) {
    for (uint32_t n = 0; n < lattice.size(); ++n)
      for (int s = 0; s < 1 + 2 * axis; ++s) {
        sends[n].records[axis] += segment[n][s];
        ++sends[n].segments[axis];
        sends[n].empty[axis] += segment[n][s] == 0;
      }
    for (uint32_t n = 0; n < lattice.size(); ++n)
      for (int face = 2 * axis; face < 2 * axis + 2; ++face)
        if (lattice.neighbour(n, face) != kNoCell)
          segment[n][1 + face] = sends[lattice.neighbour(n, face)].records[axis];
  }

  const uint64_t end_beat = kEndBeat + static_cast<uint64_t>(plan.link.latency);
  // A migrate phase in which nothing moves: end beats, their way, one cycle to leave each face's FIFO.
  const uint64_t quiet_migrate = 1 + end_beat + 2;
  const auto send_time = [&](uint32_t n, int axis, uint64_t beats) {
    const Sends& s = sends[n];
    return beats == 0 ? s.segments[axis] + 1 : s.records[axis] * beats + s.empty[axis] + 1;
  };
  ExpectedCycles expected;
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    const uint64_t own = segment[n][0];
    const uint64_t passes = ceil_div(own, static_cast<uint64_t>(plan.arch.filter_lanes));
    const uint64_t pairs = own > 0 ? pairs_of(n) : 0;
    const uint64_t issues = ceil_div(pairs, static_cast<uint64_t>(plan.arch.force_pipes)) *
                            static_cast<uint64_t>(plan.latency.interval);
    uint64_t candidates = 0;
    for (int s = 0; s < 1 + 2 * axes; ++s) candidates += segment[n][s] * passes;
    expected.ideal = std::max(expected.ideal, plan.rounds.size() * std::max(candidates, issues));
    uint64_t step = static_cast<uint64_t>(axes) * quiet_migrate;
    for (const PlanRound& round : plan.rounds) {
      std::array<uint64_t, 3> exchanged{};  // the cycle of the round at which each exchange is over
      uint64_t now = 0;
      for (int axis = 0; axis < axes; ++axis) {
        const auto beats = static_cast<uint64_t>(round.beats);
        uint64_t longest = send_time(n, axis, beats);
        for (int face = 2 * axis; face < 2 * axis + 2; ++face)
          if (lattice.neighbour(n, face) != kNoCell)
            longest = std::max(longest, send_time(lattice.neighbour(n, face), axis, beats));
        exchanged[axis] = now += longest + end_beat;
      }
      uint64_t streamed = plan.arch.overlap ? 0 : now;
      for (int s = 0; s < 1 + 2 * axes; ++s) {
        if (s > 0 && plan.arch.overlap) streamed = std::max(streamed, exchanged[(s - 1) / 2]);
        streamed += std::max<uint64_t>(segment[n][s] * passes, 1);
      }
      streamed = std::max(streamed, now + walk(n));
      // The last candidate's pairs pass F1, the queue and `current`, then the pipe.
      step += std::max(streamed + static_cast<uint64_t>(plan.latency.filter), issues) +
              (own > 0 ? 2 + static_cast<uint64_t>(round.pipe) : 0);
      step += own > 0 ? (own - 1) * static_cast<uint64_t>(plan.latency.stride) +
                            static_cast<uint64_t>(round.finish)
                      : 1;
    }
    expected.step = std::max(expected.step, step);
  }
  return expected;
}

// Nodes that use halos on arrival. Of a cell around, the box of the own particles lets pass about as many
// records as make pairs; the last one comes behind all that the relay sends.
ExpectedCycles arrival_cycles(const Plan& plan, const PairCensus& census) {
  constexpr uint64_t kRelay = 2;  // from what the relay asks for to the links' load
  const int axes = plan.rule.axes;
  const auto streamers = static_cast<uint64_t>(plan.arch.streamers);
  const auto lanes = static_cast<uint64_t>(plan.arch.filter_lanes);
  const uint64_t end_beat = kEndBeat + static_cast<uint64_t>(plan.link.latency);
  ExpectedCycles expected;
  for (uint32_t n = 0; n < plan.lattice.size(); ++n) {
    const uint64_t own = census.particles(n), passes = ceil_div(own, lanes);
    uint64_t sent = own;  // records over the last axis
    std::array<uint64_t, 2> items{}, pairs{};
    for (const auto& [other, offset] : plan.lattice.neighbourhood(n)) {
      const std::array<int8_t, 3> by{static_cast<int8_t>(offset[0]), static_cast<int8_t>(offset[1]),
                                     static_cast<int8_t>(offset[2])};
      // The face over which its records come is that of the last axis along which it lies apart.
      int last = axes - 1;
      while (last >= 0 && offset[last] == 0) --last;
      const bool here = last < 0;
      if (!here && offset[axes - 1] == 0) sent += census.particles(other);
      const size_t streamer = here || streamers == 1 || offset[last] < 0 ? 0 : 1;
      const uint64_t met = own > 0 ? census.pairs(n, by) : 0;
      items[streamer] += (here ? own : std::min(census.particles(other), met)) * passes;
      pairs[streamer] += met;
    }
    const uint64_t relayed =
        sent * static_cast<uint64_t>(plan.words.halo_beats) + static_cast<uint64_t>(axes) + kRelay + end_beat;
    uint64_t force = relayed + 1;
    for (size_t s = 0; s < streamers && own > 0; ++s) {
      const uint64_t streamed = std::max(items[s] + static_cast<uint64_t>(axes), relayed + kCullStages);
      const uint64_t issues = ceil_div(pairs[s] * streamers, static_cast<uint64_t>(plan.arch.force_pipes)) *
                              static_cast<uint64_t>(plan.latency.interval);
      expected.ideal = std::max({expected.ideal, items[s], issues});
      // The first pairs are those of the own particles, once they are through the filter. A candidate's last
      // issue leaves half of the pipes empty.
      const auto filter = static_cast<uint64_t>(plan.latency.filter);
      const uint64_t each = static_cast<uint64_t>(plan.arch.force_pipes) / streamers;
      const uint64_t uneven = std::min(items[s], pairs[s]) * (each - 1) / (2 * each);
      force = std::max(force, std::max(streamed + filter, issues + uneven + filter + 2) + 2 +
                                  static_cast<uint64_t>(plan.latency.pipe));
    }
    const uint64_t update = own > 0 ? own - 1 + static_cast<uint64_t>(plan.latency.update) : 1;
    expected.step = std::max(expected.step, force + update + static_cast<uint64_t>(axes) * end_beat);
  }
  return expected;
}

}  // namespace

PairCensus::PairCensus(const Plan& plan, const State& state)
    : particles_(plan.lattice.size()), pairs_(plan.lattice.size()) {
  const Lattice& lattice = plan.lattice;
  const Held held = held_by(lattice, state);
  const auto at = [](const Cell& offset) {
    return place(
        {static_cast<int8_t>(offset[0]), static_cast<int8_t>(offset[1]), static_cast<int8_t>(offset[2])});
  };
  const graph::BondRows* rows = plan.program == nullptr ? nullptr : plan.program->rows.get();
  std::vector<uint32_t> cell_of;  // by id, of a bonded rule
  if (rows != nullptr) {
    cell_of.resize(rows->first.size() - 1);
    for (const Particle& p : state.particles) cell_of.at(p.id) = p.cell;
  }
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    particles_[n] = held[n].size();
    if (held[n].empty()) continue;
    for (const auto& [other, offset] : lattice.neighbourhood(n))
      pairs_[n][at(offset)] = rows != nullptr ? count_bonds(*rows, held[n], cell_of, other)
                                              : count_pairs(plan.rule, held[n], held[other], offset);
  }
}

uint64_t PairCensus::pairs(uint32_t cell) const {
  return std::accumulate(pairs_[cell].begin(), pairs_[cell].end(), uint64_t{0});
}

ExpectedCycles expected_cycles(const Plan& plan, const PairCensus& census) {
  if (!plan.bricks.one_cell()) return BrickCycles(plan, census).expected();
  if (plan.arch.halos == Halos::arrival) return arrival_cycles(plan, census);
  return single_cycles(
      plan, [&](uint32_t n) { return census.particles(n); }, [&](uint32_t n) { return census.pairs(n); },
      [](uint32_t) { return uint64_t{0}; });
}

ExpectedCycles expected_cycles(const Plan& plan, const State& state) {
  if (!plan.arch.narrow_memories) return expected_cycles(plan, PairCensus(plan, state));
  const Held held = held_by(plan.lattice, state);
  return single_cycles(
      plan, [&](uint32_t n) { return held[n].size(); },
      [&](uint32_t n) {
        uint64_t pairs = 0;
        for (const auto& [other, offset] : plan.lattice.neighbourhood(n))
          pairs += count_pairs(plan.rule, held[n], held[other], offset);
        return pairs;
      },
      [&](uint32_t n) { return narrow_walk(plan, held, n); });
}

}  // namespace cuboct
