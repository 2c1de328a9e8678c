// SPDX-License-Identifier: MIT
#include "emu/timing/brick_timing.h"

#include <algorithm>

#include "emu/timing/cycles.h"
#include "emu/timing/force_time.h"
#include "emu/timing/phase_spans.h"
#include "model/base/integer_math.h"

namespace cuboct::emu {
namespace {

constexpr uint8_t bit(int axis) { return static_cast<uint8_t>(1u << axis); }

}  // namespace

BrickMigration::BrickMigration(const Plan& plan)
    : plan_(plan), leaving_(plan.lattice.size()), arrived_(plan.lattice.size()), events_(plan.nodes()) {
  for (auto* cycles : {&scan_, &land_})
    for (auto& of_axis : *cycles) of_axis.resize(plan.nodes());
}

// Whether the step over this face of a cell leaves its brick.
bool BrickMigration::crosses(uint32_t cell, int face) const {
  const uint32_t node = plan_.node_of(cell);
  const int axis = face / 2;
  const int32_t inside = plan_.lattice.cell(cell)[axis] - plan_.low_of(node)[axis];
  return inside == (face % 2 == 1 ? plan_.bricks.extent(node)[axis] - 1 : 0);
}

void BrickMigration::plan(std::vector<uint32_t>& count, std::span<const Leaving> leaving,
                          const BrickMap& map) {
  any_ = !leaving.empty();
  if (!any_) return;
  movers_.clear();
  std::fill(events_.begin(), events_.end(), MachineEvents{});
  std::fill(leaving_.begin(), leaving_.end(), 0);
  for (const Leaving& l : leaving) {
    movers_.push_back({l.cell, l.away});
    for (int a = 0; a < 3; ++a)
      if (l.away[at(a)] != 0) leaving_[l.cell] |= bit(a);
  }
  for (int axis = 0; axis < plan_.rule.axes; ++axis) move(axis, count, map);
}

void BrickMigration::move(int axis, std::vector<uint32_t>& count, const BrickMap& map) {
  auto &scan = scan_[at(axis)], &land = land_[at(axis)];
  for (uint32_t n = 0; n < plan_.nodes(); ++n) {
    bool any = false;
    int64_t cycles = 0;
    for (const uint32_t local : map.walk(n).own) {
      const uint32_t cell = plan_.cell_of(n, local);
      const bool leaves = cell != kNoCell && (leaving_[cell] & bit(axis)) != 0;
      any = any || leaves;
      cycles += leaves ? std::max<int64_t>(count[cell], 1) : 1;
      if (leaves) events_[n].scanned += count[cell];
    }
    scan[n] = any ? cycles : 0;
    land[n] = 0;
  }
  std::fill(arrived_.begin(), arrived_.end(), 0);
  for (Mover& m : movers_) {
    const auto direction = static_cast<int>(m.away[at(axis)]);
    if (direction == 0) continue;
    const int face = 2 * axis + (direction > 0);
    const uint32_t to = plan_.lattice.neighbour(m.cell, face);
    if (to == kNoCell) throw std::invalid_argument("a particle leaves the lattice");
    MachineEvents& events = events_[plan_.node_of(m.cell)];
    if (crosses(m.cell, face)) {
      scan[plan_.node_of(m.cell)] += plan_.words.migrate_beats - 1;
      ++events.left;
      events.beats += static_cast<uint64_t>(plan_.words.migrate_beats);
      ++events_[plan_.node_of(to)].moved;
    } else {
      ++events.inner;
    }
    --count[m.cell];
    ++arrived_[to];
    land[plan_.node_of(to)] = 1;
    m.cell = to;
    m.away[at(axis)] = 0;
    for (int later = axis + 1; later < 3; ++later)
      if (m.away[at(later)] != 0) leaving_[to] |= bit(later);
  }
  for (uint32_t n = 0; n < plan_.nodes(); ++n) {
    if (land[n] == 0) continue;
    land[n] = 0;
    for (const uint32_t local : map.walk(n).own) {
      const uint32_t cell = plan_.cell_of(n, local);
      const uint32_t come = cell == kNoCell ? 0 : arrived_[cell];
      land[n] += std::max<int64_t>(come, 1);
      if (come > 0) count[cell] += come;
    }
  }
}

BrickTiming::BrickTiming(const Plan& plan, int threads)
    : NodeTiming(plan, threads),
      map_(plan.lattice, plan.bricks, plan.rule.axes),
      halo_beats_(plan.words.halo_beats),
      shape_{plan.arch.queue_depth, plan.latency.pipe, plan.rule.axes, plan.latency.interval},
      filter_(plan.rule, plan.arch.filter_lanes, plan.arch.force_pipes),
      migration_(plan),
      by_cell_(plan.lattice, plan.words.migrate_beats, 0),
      halo_end_(nodes_),
      sent_(nodes_),
      scratch_(static_cast<size_t>(threads_)) {
  for (auto& cycles : migrate_end_) cycles.resize(nodes_);
}

void BrickTiming::begin(std::span<const Leaving> leaving) {
  migration_.plan(final_count_, leaving, map_);
  if (!links_.any()) return;
  by_cell_count_ = count_;
  by_cell_.plan(by_cell_count_, leaving);
}

// Cycles of a walk over the node's own cells.
int64_t BrickTiming::walk(uint32_t n, const uint32_t* first) const {
  int64_t cycles = 0;
  for (const uint32_t local : map_.walk(n).own) {
    const uint32_t cell = plan_.cell_of(n, local);
    cycles += cell == kNoCell ? 1 : std::max<int64_t>(first[cell + 1] - first[cell], 1);
  }
  return cycles;
}

// The layer that goes over `face` is loaded into the registers of `faces` from `start` on; the cycle that
// loads the end beat.
int64_t BrickTiming::load_layer(uint8_t faces, int face, uint32_t n, int64_t start) {
  int64_t now = start;
  for (const BrickWalk::Sent& s : map_.walk(n).sent[at(face)]) {
    const uint32_t cell = map_.cell(n, s.grid);
    const int64_t records = cell == kNoCell ? 0 : count_[cell];
    now = records == 0 ? now + 1 : links_.load(n, faces, now, records * halo_beats_) + 1;
  }
  return links_.load(n, faces, now, 1);
}

uint64_t BrickTiming::layer_records(int face, uint32_t n, bool own) const {
  uint64_t records = 0;
  for (const BrickWalk::Sent& s : map_.walk(n).sent[at(face)])
    if (const uint32_t cell = map_.cell(n, s.grid); cell != kNoCell && (!own || s.local >= 0))
      records += count_[cell];
  return records;
}

// The cycles in which the end beats of EXCHANGE_a are loaded.
void BrickTiming::send(int axis, uint32_t n) {
  int64_t now = axis == 0 ? start_[n] : end_[at(axis - 1)][n] + 1;
  const bool thin = plan_.bricks.shape()[axis] == 1;
  for (int side = 0; side < 2; ++side) {
    const int face = 2 * axis + side;
    const bool linked = plan_.neighbour(n, face) != kNoNode;
    if (thin && linked) {  // both at once
      const int64_t end = load_layer(faces_along(axis), face, n, now);
      halo_end_[n][at(face)] = halo_end_[n][at(face ^ 1)] = sent_[n][at(axis)] = end;
      return;
    }
    if (thin) {
      sent_[n][at(axis)] = now;
      continue;
    }
    if (linked) now = load_layer(static_cast<uint8_t>(1u << face), face, n, now);
    halo_end_[n][at(face)] = sent_[n][at(axis)] = now++;
  }
}

// The cycle in which a node sees over `face` the end beat that its neighbour there loaded in `end`.
int64_t BrickTiming::ended(int64_t end, uint32_t near, int face) const {
  return links_.cut(near, face ^ 1) ? links_.seen(near, face ^ 1) : end + received_;
}

// The last cycle of EXCHANGE_a.
int64_t BrickTiming::exchanged(int axis, uint32_t n) const {
  int64_t last = sent_[n][at(axis)] + kSent;
  for (int face = 2 * axis; face < 2 * axis + 2; ++face)
    if (const uint32_t near = plan_.neighbour(n, face); near != kNoNode)
      last = std::max(last, ended(halo_end_[near][at(face ^ 1)], near, face));
  return last;
}

// The items of a cell's candidates before the own slots that lie in `scratch`: `planar` of hits.h.
void BrickTiming::meet(const CellSlots& slots, uint32_t cell, const std::array<int8_t, 3>& offset, bool same,
                       uint32_t& item, Scratch& scratch) const {
  const PlanarBounds& test = filter_.test;
  const auto own = static_cast<uint32_t>(scratch.own[0].size());
  for (uint32_t k = slots.first[cell]; k < slots.first[cell + 1]; ++k) {
    std::array<int32_t, 3> x;
    for (size_t a = 0; a < 3; ++a)
      x[a] = static_cast<int32_t>(slots.x[a][k] + (int64_t{offset[a]} << test.position_frac)) >> test.shift;
    for (uint32_t from = 0; from < own; from += filter_.lanes, ++item) {
      const uint32_t to = std::min(own, from + filter_.lanes);
      int32_t hits = 0;
      for (uint32_t i = from; i < to; ++i) {
        const auto size = [&](size_t a) {
          const int32_t e = x[a] - scratch.own[a][i];
          return e ^ (e >> 31);
        };
        const int32_t dx = size(0), dy = size(1), dz = size(2);
        const int32_t all = dx + dy + dz;
        const int32_t most = std::max({dx, dy, dz}), least = std::min({dx, dy, dz});
        hits += most <= test.planar[0] && all - least <= test.planar[1] && all <= test.planar[2];
      }
      const uint32_t slot = k - slots.first[cell];
      if (same && slot >= from && slot < to) --hits;
      if (hits == 0) continue;
      scratch.entries.push_back(
          ForceWork::entry(item, static_cast<uint32_t>(ceil_div(int64_t{hits}, int64_t{filter_.pipes}))));
      scratch.pairs += static_cast<uint64_t>(hits);
    }
  }
}

// The engine's last cycle. A visit at which nobody meets is an item without hits.
int64_t BrickTiming::force(const CellSlots& slots, uint32_t n, Scratch& scratch) {
  const int64_t begin = plan_.arch.overlap ? start_[n] : end_[at(Phase::exchange_z)][n] + 1;
  Available available;
  for (int a = 0; a < 3; ++a) available[at(a)] = end_[at(a)][n] + 1 - begin;
  const BrickWalk& walk = map_.walk(n);
  ForceWork work;
  scratch.entries.clear();
  scratch.idle = {};
  scratch.pairs = 0;
  uint32_t item = 0;
  for (size_t segment = 0; segment < work.items.size(); ++segment) {
    const uint32_t first = item;
    for (const BrickWalk::Visit& visit : walk.visits[segment]) {
      const uint32_t own = plan_.cell_of(n, visit.own);
      if (own == kNoCell || count_[own] == 0) {
        ++item, ++scratch.idle[segment];
        continue;
      }
      for (size_t a = 0; a < 3; ++a) {
        scratch.own[a].clear();
        for (uint32_t k = slots.first[own]; k < slots.first[own + 1]; ++k)
          scratch.own[a].push_back(slots.x[a][k] >> filter_.test.shift);
      }
      for (uint32_t k = visit.first; k < visit.end; ++k) {
        const BrickWalk::Near& near = walk.near[k];
        const uint32_t cell = map_.cell(n, near.grid);
        if (cell == kNoCell || count_[cell] == 0)
          ++item, ++scratch.idle[segment];
        else
          meet(slots, cell, near.offset, near.offset == std::array<int8_t, 3>{}, item, scratch);
      }
    }
    work.items[segment] = item - first;
  }
  work.entries = scratch.entries;
  for (int64_t& from : available) from = std::max<int64_t>(from, 0);
  work.pairs = scratch.pairs;
  const ForceTime time = force_time(shape_, work, available, scratch.popped);
  MachineEvents& events = events_[n];
  count_work(work, true, events);
  for (size_t segment = 0; segment < scratch.idle.size(); ++segment) {
    events.candidates -= scratch.idle[segment];
    if (segment > 0) candidates_along(events, static_cast<int>(segment - 1) / 2) -= scratch.idle[segment];
  }
  events.queue_stalls += static_cast<uint64_t>(time.stalls);
  return begin + time.last;
}

void BrickTiming::exchange_to_update(const CellSlots& slots, uint32_t n, Scratch& scratch) {
  end_[at(Phase::exchange_z)][n] = axes_ == 3 ? exchanged(2, n) : end_[at(Phase::exchange_y)][n];
  const int64_t force_end = end_[at(Phase::force)][n] = force(slots, n, scratch);
  int64_t held = 0;
  for (const uint32_t local : map_.walk(n).own)
    if (const uint32_t cell = plan_.cell_of(n, local); cell != kNoCell) held += count_[cell];
  const int64_t end = end_[at(Phase::update)][n] =
      force_end + (held == 0 ? 1 : walk(n, slots.first.data()) - 1 + plan_.latency.update);
  migrate_end_[0][n] = scanned(0, n, end + 1);
}

// The cycle that loads the end beats behind SCAN, whose first cycle is `start`.
int64_t BrickTiming::scanned(int axis, uint32_t n, int64_t start) {
  const int64_t scan = migration_.scan(axis, n);
  if (!links_.any() || scan == 0) return links_.load(n, faces_along(axis), start + scan, 1);
  int64_t now = start;
  for (const uint32_t local : map_.walk(n).own) {
    const uint32_t cell = plan_.cell_of(n, local);
    const int64_t slots = cell == kNoCell ? 0 : by_cell_.scanned(axis, cell).slots;
    if (slots == 0) {
      ++now;
      continue;
    }
    int64_t slot = 0;
    for (const auto& d : by_cell_.departures(axis, cell).departures) {
      now += d.slot - slot;
      slot = d.slot + 1;
      now = migration_.crosses(cell, d.face)
                ? links_.load(n, static_cast<uint8_t>(1u << d.face), now, plan_.words.migrate_beats) + 1
                : now + 1;
    }
    now += slots - slot;
  }
  return links_.load(n, faces_along(axis), now, 1);
}

void BrickTiming::take_particles(int axis, uint32_t n) {
  int64_t last = migrate_end_[at(axis)][n] + 1;
  for (int face = 2 * axis; face < 2 * axis + 2; ++face)
    if (const uint32_t near = plan_.neighbour(n, face); near != kNoNode)
      last = std::max(last, ended(migrate_end_[at(axis)][near], near, face));
  last += migration_.land(axis, n);
  end_[at(Phase::migrate_x) + at(axis)][n] = last;
  if (axis + 1 < axes_) migrate_end_[at(axis + 1)][n] = scanned(axis + 1, n, last + 1);
}

// A brick one cell thick reads what it sends along the axis once for both links.
void BrickTiming::count_records(uint32_t n) {
  MachineEvents& events = events_[n];
  for (const uint32_t local : map_.walk(n).own)
    if (const uint32_t cell = plan_.cell_of(n, local); cell != kNoCell) events.updates += count_[cell];
  for (int axis = 0; axis < axes_; ++axis) {
    bool read = false;  // by the walk for the other link
    for (int face = 2 * axis; face < 2 * axis + 2; ++face) {
      const uint32_t near = plan_.neighbour(n, face);
      if (near == kNoNode) continue;
      const uint64_t records = layer_records(face, n, false);
      if (!read) events.relayed += records, events.relayed_own += layer_records(face, n, true);
      read = plan_.bricks.shape()[axis] == 1;
      halos_along(events, axis) += layer_records(face ^ 1, near, false);
      // And the end beats, of records and of particles.
      events.beats += records * static_cast<uint64_t>(halo_beats_) + 2;
    }
  }
}

// Where an axis does not exist its phases end with those before them.
void BrickTiming::finish(uint32_t n, std::span<PhaseSpan> spans) {
  if (axes_ == 2) end_[at(Phase::migrate_z)][n] = end_[at(Phase::migrate_y)][n];
  count_records(n);
  migration_.count(n, events_[n]);
  write_spans(spans, n, start_[n], end_, 1, plan_.arch.overlap, events_[n]);
  start_[n] = end_[at(Phase::migrate_z)][n] + 1;
}

void BrickTiming::step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) {
  take(slots, leaving, spans);
  begin(leaving);
  const auto work = int64_t{plan_.lattice.size()} + 2 * int64_t{slots.first.back()};
  const int threads = static_cast<int>(
      std::clamp<int64_t>(work / kWorkPerThread, 1, std::min<int64_t>(threads_, int64_t{nodes_})));
  const auto for_all = [&](const auto& part) {
    for_each_part(nodes_, threads, [&](size_t n, int) { part(static_cast<uint32_t>(n)); });
  };
  for_all([&](uint32_t n) { send(0, n); });
  for (int axis = 0; axis + 1 < axes_; ++axis) {
    for_all([&](uint32_t n) { end_[at(axis)][n] = exchanged(axis, n); });
    for_all([&](uint32_t n) { send(axis + 1, n); });
  }
  if (axes_ == 2) for_all([&](uint32_t n) { end_[at(Phase::exchange_y)][n] = exchanged(1, n); });
  for_each_part(nodes_, threads, [&](size_t n, int member) {
    exchange_to_update(slots, static_cast<uint32_t>(n), scratch_[at(member)]);
  });
  for (int axis = 0; axis < axes_; ++axis) for_all([&](uint32_t n) { take_particles(axis, n); });
  for_all([&](uint32_t n) { finish(n, spans); });
  ++steps_;
  for (uint32_t n = 0; n < nodes_; ++n) {
    const bool busy = std::any_of(map_.walk(n).own.begin(), map_.walk(n).own.end(), [&](uint32_t local) {
      const uint32_t cell = plan_.cell_of(n, local);
      return cell != kNoCell && count_[cell] > 0;
    });
    counters_.busy += busy, counters_.filtered += busy, counters_.walked += busy;
  }
}

}  // namespace cuboct::emu
