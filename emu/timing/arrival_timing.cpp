// SPDX-License-Identifier: MIT
#include "emu/timing/arrival_timing.h"

#include <algorithm>

#include "emu/timing/cycles.h"
#include "emu/timing/phase_spans.h"

namespace cuboct::emu {
namespace {

// A thread must have so many nodes and particles beside the barriers of the step.
constexpr int64_t kArrivalWorkPerThread = 100;

}  // namespace

// All parts of the relay move together, but for cycles in which the links load a beat that is not a record's
// last.
void ArrivalTiming::Relay::act(int64_t there) {
  asked = std::max(asked + 1, loaded);
  loaded = std::max(loaded, answered);
  if (there > asked) asked = std::max(there, loaded);
}

// The streamer acts again when what it did `filter` acts before leaves the filter.
struct ArrivalTiming::Stream {
  Stream(const Plan& plan, int64_t begin, std::vector<int64_t>& popped, MachineEvents& node_events)
      : depth(static_cast<size_t>(plan.arch.queue_depth)),
        pipes(plan.arch.force_pipes / plan.arch.streamers),
        interval(plan.latency.interval),
        pipe(plan.latency.pipe),
        leaves(at(plan.latency.filter)),
        pop(popped),
        events(node_events) {
    for (size_t k = 0; k < leaves.size(); ++k) leaves[k] = begin + static_cast<int64_t>(k);
    pop.assign(depth, kLongAgo);
  }

  void leave(int64_t cycle) {
    std::copy(leaves.begin() + 1, leaves.end(), leaves.begin());
    leaves.back() = cycle;
  }
  // The cycle of the next act, at `from` or later.
  int64_t act(int64_t from) {
    for (size_t k = 0; k < leaves.size() && from > leaves.front(); ++k) leave(leaves.back() + 1);
    if (const int64_t wait = from - leaves.front(); wait > 0)
      for (int64_t& cycle : leaves) cycle += wait;
    return streamed = leaves.front();
  }
  void present(int64_t from, int hits) {
    act(from);
    ++events.candidates;
    filtered = leaves.back() + 1;
    if (hits > 0) {
      const int64_t room = pop[pop.size() - depth] + 1;
      if (room > filtered) events.queue_stalls += static_cast<uint64_t>(room - filtered), filtered = room;
      const int64_t moved = std::max(issued, filtered + 1);
      pop.push_back(moved);
      const int64_t issues = (hits + pipes - 1) / pipes;
      issued = moved + issues * interval;
      ++events.entries;
      events.issues += static_cast<uint64_t>(issues);
      events.pairs += static_cast<uint64_t>(hits);
    }
    leave(filtered);
  }
  // After a segment's items, if any: it is known from `complete` on that there is no other.
  void next_segment(bool empty, int64_t complete) {
    if (!empty && complete <= streamed) return;
    act(complete);
    leave(leaves.back() + 1);
  }
  int64_t last() const { return std::max({streamed + 2, filtered + 2, issued - (interval - 1) + pipe}); }

  const size_t depth;
  const int64_t pipes, interval, pipe;
  std::vector<int64_t> leaves;  // cycles in which the last acts leave the filter, the oldest first
  std::vector<int64_t>&
      pop;  // cycles in which entries leave the queue, after as many of long ago as it holds
  MachineEvents& events;
  int64_t issued = kLongAgo, streamed = 0, filtered = kLongAgo;
};

ArrivalTiming::ArrivalTiming(const Plan& plan, int threads)
    : CellTiming(plan, threads, kAnswered),
      shift_(plan.rule.widths.position_frac - plan.rule.widths.filter_frac),
      halo_beats_(plan.words.halo_beats),
      sent_(nodes_ + 1),
      scratch_(at(threads_)) {
  for (size_t k = 0; k < 3; ++k) planar_[k] = static_cast<int32_t>(plan.rule.planar[k]);
  sent_[nodes_].end.fill(kLongAgo);
  for (auto* beats : {&migrate_start_, &migrate_end_})
    for (auto& cycles : *beats) cycles.assign(nodes_ + 1, kLongAgo);
}

// The segments of an axis: own particles before the first, then the halos of the axis before.
void ArrivalTiming::relay(int axis, uint32_t n) {
  Sent& sent = sent_[n];
  Relay& relay = sent.relay;
  const auto cut = [&](int face) { return links_.cut(n, face); };
  uint8_t faces = 0;  // of this axis and those behind it
  for (int a = axis; a < axes_; ++a) faces |= faces_along(a);
  const auto segment = [&](uint32_t count, int64_t complete, const auto& there) {
    for (uint32_t k = 0; k < count; ++k) {
      relay.act(there(k));
      relay.answered = links_.load(n, faces, relay.sends(), halo_beats_);
      sent.record.push_back(relay.answered);
      for (int f = 2 * axis; f < 2 * axes_ && links_.any(); ++f)
        if (cut(f)) sent.seen[at(f)].push_back(links_.seen(n, f));
    }
    if (count == 0 || complete > relay.asked) relay.act(complete);
  };
  if (axis == 0) {
    relay = {start_[n] - 1};
    for (auto& seen : sent.seen) seen.clear();
    // Neighbours read the records of an axis while those of the next are appended: no one moves them.
    size_t records = 0;
    for (const uint32_t y : {n, other(n, 2), other(n, 3)})
      for (const uint32_t x : {y, other(y, 0), other(y, 1)}) records += count_[x];
    sent.record.clear();
    sent.record.reserve(records);
    segment(count_[n], kLongAgo, [](uint32_t) { return kLongAgo; });
  } else {
    for (int side = 0; side < 2; ++side) {
      const int face = 2 * axis - 2 + side;
      const uint32_t from = other(n, face);
      segment(sent_[from].records[at(axis - 1)], ended(from, face ^ 1),
              [&](uint32_t k) { return came(from, face ^ 1, k); });
    }
  }
  sent.records[at(axis)] = static_cast<uint32_t>(sent.record.size());
  relay.act(kLongAgo);
  sent.end[at(axis)] = relay.answered = links_.load(n, faces_along(axis), relay.sends(), 1);
  for (const int f : {2 * axis, 2 * axis + 1})
    if (cut(f)) sent.end_seen[at(f)] = links_.seen(n, f);
}

bool ArrivalTiming::near(const std::array<int32_t, 3>& own, const std::array<int32_t, 3>& other_x) const {
  std::array<int32_t, 3> size;
  for (size_t a = 0; a < 3; ++a) {
    const int32_t e = other_x[a] - own[a];
    size[a] = e ^ (e >> 31);
  }
  const auto [x, y, z] = size;
  return std::max({x, y, z}) <= planar_[0] && std::max({x + y, y + z, z + x}) <= planar_[1] &&
         x + y + z <= planar_[2];
}

// A face's halo is what its neighbour holds, then what that one's neighbours along the axes before do, -x
// before +x: nested walks over the axes, the last one outermost. `loaded` counts the neighbour's relay.
void ArrivalTiming::gather(const CellSlots& slots, uint32_t n, int face, const std::array<int32_t, 3>& low,
                           const std::array<int32_t, 3>& high, std::vector<Halo>& halo,
                           MachineEvents& events) const {
  halo.clear();
  const int axis = face / 2, cell = 1 << plan_.rule.widths.position_frac;
  const uint32_t sender = other(n, face);
  size_t loaded = 0;
  const auto visit = [&](uint32_t of, const std::array<int32_t, 3>& by) {
    if (of == nodes_) return;
    for (uint32_t k = slots.first[of]; k < slots.first[of + 1]; ++k) {
      const int64_t seen = came(sender, face ^ 1, loaded++);
      Halo h{seen + kCullStages, {}};
      std::array<int32_t, 3> nearest;
      for (size_t a = 0; a < 3; ++a) {
        h.x[a] = (slots.x[a][k] + by[a]) >> shift_;
        nearest[a] = std::clamp(h.x[a], low[a], high[a]);
      }
      // What came before the step was not tested.
      const bool tested = seen >= start_[n];
      events.tested += tested;
      if (!tested || (count_[n] > 0 && near(nearest, h.x)))
        halo.push_back(h);
      else
        ++culled_along(events, axis);
    }
  };
  std::array<int32_t, 3> by{};
  by[at(axis)] = face % 2 == 0 ? -cell : cell;
  const uint32_t first = other(n, face);
  constexpr int kWays = 3;  // here, below, above
  const auto way = [&](uint32_t of, int a, int w) { return w == 0 ? of : other(of, 2 * a + w - 1); };
  for (int wy = 0; wy < (axis == 2 ? kWays : 1); ++wy)
    for (int wx = 0; wx < (axis >= 1 ? kWays : 1); ++wx) {
      std::array<int32_t, 3> to = by;
      if (wy > 0) to[1] += wy == 1 ? -cell : cell;
      if (wx > 0) to[0] += wx == 1 ? -cell : cell;
      visit(way(way(first, 1, wy), 0, wx), to);
    }
}

int64_t ArrivalTiming::force(const CellSlots& slots, uint32_t n, Scratch& scratch) {
  const uint32_t count = count_[n];
  std::array<int32_t, 3> low{}, high{};
  for (size_t a = 0; a < 3; ++a) {
    auto& own = scratch.own[a];
    own.clear();
    for (uint32_t k = slots.first[n]; k < slots.first[n + 1]; ++k) own.push_back(slots.x[a][k] >> shift_);
    if (count == 0) continue;
    const auto [least, most] = std::ranges::minmax(own);
    low[a] = least, high[a] = most;
  }
  const auto lanes = static_cast<uint32_t>(plan_.arch.filter_lanes);
  const auto present = [&](Stream& stream, int64_t from, const std::array<int32_t, 3>& x, uint32_t self) {
    for (uint32_t pass = 0; pass < count; pass += lanes) {
      int hits = 0;
      for (uint32_t k = pass; k < std::min(count, pass + lanes); ++k)
        hits += k != self && near({scratch.own[0][k], scratch.own[1][k], scratch.own[2][k]}, x);
      stream.present(from, hits);
    }
  };
  int64_t last = end_[at(axes_ == 3 ? Phase::exchange_z : Phase::exchange_y)][n] + 1;
  const int streamers = plan_.arch.streamers;
  for (int s = 0; s < streamers; ++s) {
    Stream stream(plan_, start_[n], scratch.popped, events_[n]);
    if (s == 0) {
      for (uint32_t k = 0; k < count; ++k)
        present(stream, start_[n], {scratch.own[0][k], scratch.own[1][k], scratch.own[2][k]}, k);
      stream.next_segment(count == 0, start_[n]);
    }
    for (int face = s; face < 2 * axes_; face += streamers) {
      scratch.halo.clear();
      gather(slots, n, face, low, high, scratch.halo, events_[n]);
      if (count == 0) scratch.halo.clear();
      const uint64_t before = events_[n].candidates;
      for (const Halo& h : scratch.halo) present(stream, h.from, h.x, count);
      candidates_along(events_[n], face / 2) += events_[n].candidates - before;
      const int64_t complete = ended(other(n, face), face ^ 1) + kCullStages;
      stream.next_segment(scratch.halo.empty(), std::max(complete, start_[n]));
    }
    last = std::max(last, stream.last());
  }
  return last;
}

void ArrivalTiming::exchange_to_update(const CellSlots& slots, uint32_t n, Scratch& scratch) {
  int64_t last = start_[n] - 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis < axes_) {
      last = std::max(last + 1, sent_[n].end[at(axis)] + kSent);
      for (const int face : {2 * axis, 2 * axis + 1}) last = std::max(last, ended(other(n, face), face ^ 1));
    }
    end_[at(axis)][n] = last;
  }
  const int64_t force_end = end_[at(Phase::force)][n] = force(slots, n, scratch);
  const int64_t update = count_[n] == 0 ? 1 : int64_t{count_[n]} - 1 + plan_.latency.update;
  end_[at(Phase::update)][n] = force_end + update;
  end_beats(0, n, force_end + update + 1);
}

// Where no particle leaves the end beats are loaded in the last cycle of the phase before.
void ArrivalTiming::end_beats(int axis, uint32_t n, int64_t start) {
  const int64_t scan = migration_.any() ? migration_.scan(axis, n) : 0;
  migrate_start_[at(axis)][n] = start;
  const uint8_t faces = faces_along(axis);
  // That cycle asks for empty registers; a register that is emptied in a cycle was not empty in it.
  const bool early = scan == 0 && links_.can_load(n, faces) < start - 1;
  migrate_end_[at(axis)][n] = links_.load(n, faces, early ? start - 1 : scanned(axis, n, start), 1);
}

void ArrivalTiming::take_particles(int axis, uint32_t n) {
  // A phase does not end in the cycle after one that takes a particle.
  int64_t now = migrate_end_[at(axis)][n] + 1, settled = kLongAgo;
  const auto take = [&](int side) {
    if (migration_.any())
      for (const auto& arrival : migration_.arrivals(axis, n, side)) {
        const int64_t seen = links_.any() ? seen_[at(axis)][arrival.departure]
                                          : migrate_start_[at(axis)][arrival.from] + arrival.after;
        now = std::max(now, seen) + 1;
        settled = now + 1;
      }
  };
  const auto all_came = [&](int side) {
    const int face = 2 * axis + side;
    return migrated(other(n, face), face ^ 1);
  };
  take(0);
  now = std::max(now, all_came(0));
  const bool some_above = migration_.any() && !migration_.arrivals(axis, n, 1).empty();
  if (some_above || all_came(1) > now || settled > now) {
    ++now;
    take(1);
    now = std::max({now, all_came(1), settled});
  }
  end_[at(Phase::migrate_x) + at(axis)][n] = now;
}

// A relay reads a record once for all its links.
void ArrivalTiming::count_records(uint32_t n) {
  MachineEvents& events = events_[n];
  events.updates += count_[n];
  events.relayed += sent_[n].record.size();
  events.relayed_own += count_[n];
  for (int face = 0; face < 2 * axes_; ++face) {
    const uint32_t near = other(n, face);
    if (near == nodes_) continue;
    halos_along(events, face / 2) += sent_[near].records[at(face / 2)];
    // And the end beats, of records and of particles.
    events.beats += sent_[n].records[at(face / 2)] * static_cast<uint64_t>(halo_beats_) + 2;
  }
  migration_.count(n, axes_, events);
}

void ArrivalTiming::step(const CellSlots& slots, std::span<const Leaving> leaving,
                         std::span<PhaseSpan> spans) {
  take(slots, leaving, spans);
  plan_migration(leaving);
  const int64_t work = int64_t{nodes_} + 10 * int64_t{slots.first[nodes_]};
  const int threads = static_cast<int>(
      std::clamp<int64_t>(work / kArrivalWorkPerThread, 1, std::min<int64_t>(threads_, int64_t{nodes_})));
  for (int axis = 0; axis < axes_; ++axis) for_all(threads, [&](uint32_t n) { relay(axis, n); });
  for_all_busy(threads, [&](uint32_t n, int member) { exchange_to_update(slots, n, scratch_[at(member)]); });
  for (int axis = 0; axis < axes_; ++axis) {
    for_all(threads, [&](uint32_t n) { take_particles(axis, n); });
    if (axis + 1 < axes_)
      for_all(threads,
              [&](uint32_t n) { end_beats(axis + 1, n, end_[at(Phase::migrate_x) + at(axis)][n] + 1); });
  }
  for_all(threads, [&](uint32_t n) {
    if (axes_ == 2) end_[at(Phase::migrate_z)][n] = end_[at(Phase::migrate_y)][n];
    count_records(n);
    write_spans(spans, n, start_[n], end_, 1, true, events_[n]);
    start_[n] = end_[at(Phase::migrate_z)][n] + 1;
  });
  ++steps_;
  for (uint32_t n = 0; n < nodes_; ++n) {
    const bool busy = count_[n] > 0;
    counters_.busy += busy, counters_.filtered += busy, counters_.walked += busy;
  }
}

}  // namespace cuboct::emu
