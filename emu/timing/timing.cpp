// SPDX-License-Identifier: MIT
#include "emu/timing/timing.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "emu/timing/arrival_timing.h"
#include "emu/timing/brick_timing.h"
#include "emu/timing/cycles.h"
#include "emu/timing/device_links.h"
#include "emu/timing/force_time.h"
#include "emu/timing/hits.h"
#include "emu/timing/migrate_time.h"
#include "emu/timing/phase_spans.h"
#include "model/base/parallel.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

using Cycles = std::vector<int64_t>;  // by node

struct Scratch {
  HitScratch hits;
  TimingCounters counters;
};

}  // namespace

struct TimingModel::Impl {
  Impl(const Plan& plan, int threads);

  void begin(const CellSlots& slots, std::span<const Leaving> leaving);
  // One node's part of a step, pass by pass (those up to the update once per round, take_particles once per
  // axis): each pass needs of the neighbours what they did in the passes before.
  void send_x(uint32_t n);
  void exchange_x(const CellSlots& slots, uint32_t n);
  void exchange_y(uint32_t n);
  void exchange_z_to_update(uint32_t n, Scratch& scratch);
  void take_particles(int axis, uint32_t n);
  void finish(uint32_t n, std::span<PhaseSpan> spans);

  int64_t beats() const { return plan_.rounds[at(round_)].beats; }  // of a record
  int64_t& end_of(Phase phase, uint32_t n) { return end_[at(phase_index(phase, round_, rounds_))][n]; }
  void place(const CellSlots& slots, uint32_t n);
  bool still(uint32_t n) const;
  int64_t sent(int axis, uint32_t n, int64_t start, std::initializer_list<uint32_t> segments);
  int64_t ended(const std::array<Cycles, 3>& end, int axis, uint32_t n, int side) const;
  int64_t exchanged(int axis, uint32_t n) const;
  int64_t force(uint32_t n, Scratch& scratch);
  void send_particles(int axis, uint32_t n, int64_t start);
  int64_t scanned(int axis, uint32_t n, int64_t start);
  int64_t taken(int axis, uint32_t n, int side, int64_t now) const;
  void count_records(uint32_t n);

  const Plan& plan_;
  const uint32_t nodes_;
  const int axes_;
  const int threads_;
  const int rounds_;
  const graph::BondRows* const rows_;  // of a bonded rule
  const int64_t received_;
  std::vector<ForceShape> shape_;  // by round
  const Filter filter_;
  std::vector<std::array<uint32_t, 6>> neighbour_;  // nodes + 1; number `nodes_` where there is none
  const int64_t take_;                              // cycles of TAKE per particle
  const int64_t answered_;                          // until a particle that was received is seen
  Migration migration_;
  DeviceLinks links_;
  std::array<Cycles, 3> seen_;  // with several devices: [axis][departure] the cycle in which it is seen

  // Of the step, nodes + 1 each: the one that does not exist is empty.
  std::array<std::vector<int32_t>, 3> x_, old_x_;  // at its start, and at that of the step before
  std::vector<uint32_t> first_, old_first_;        // one more
  std::vector<uint32_t> id_;                       // of a bonded rule
  std::vector<NodeSlot> where_;                    // of a bonded rule, by id
  std::vector<uint32_t> count_, final_count_;      // particles at its start, at its end
  std::vector<uint8_t> changed_;  // other particles than in the step before, or another order
  // ... or another position, where hits depend on it; there, or in a neighbour along x too.
  std::vector<uint8_t> moved_, moved_x_;
  std::vector<uint32_t> sent_y_, sent_z_;  // records that it sends along y, z

  Cycles start_;             // the step's first cycle
  int round_ = 0;            // that is looked at
  Cycles begin_;             // its first cycle
  std::vector<Cycles> end_;  // the phases' last cycles
  std::array<Cycles, 3> halo_end_, migrate_end_,
      migrate_start_;                          // [axis] cycle that loads the end beat; first cycle
  std::vector<std::vector<NodeForce>> force_;  // by round, then node
  std::vector<MachineEvents> events_;
  std::vector<Scratch> scratch_;  // by thread
  uint64_t steps_ = 0;
  TimingCounters counters_;
};

TimingModel::Impl::Impl(const Plan& plan, int threads)
    : plan_(plan),
      nodes_(plan.lattice.size()),
      axes_(plan.rule.axes),
      threads_(threads > 0 ? threads : usable_cores()),
      rounds_(static_cast<int>(plan.rounds.size())),
      rows_(plan.program ? plan.program->rows.get() : nullptr),
      received_(kReceived + plan.link.latency),
      filter_(plan.rule, plan.arch.filter_lanes, plan.arch.force_pipes),
      neighbour_(nodes_ + 1),
      take_(plan.arch.narrow_memories ? plan.words.migrate_beats + 2 : 1),
      answered_(plan.arch.narrow_memories ? 0 : kAnswered),
      migration_(plan.lattice, plan.words.migrate_beats, static_cast<int>(received_ + answered_)),
      links_(plan),
      first_(nodes_ + 2),
      old_first_(nodes_ + 2),
      count_(nodes_ + 1),
      final_count_(nodes_ + 1),
      changed_(nodes_ + 1),
      moved_(nodes_ + 1),
      moved_x_(nodes_ + 1),
      sent_y_(nodes_ + 1),
      sent_z_(nodes_ + 1),
      start_(nodes_ + 1),
      begin_(nodes_ + 1),
      end_(static_cast<size_t>(phases_of(rounds_))),
      force_(plan.rounds.size()),
      events_(nodes_) {
  neighbour_[nodes_].fill(nodes_);
  for (uint32_t n = 0; n < nodes_; ++n)
    for (int f = 0; f < kFaces; ++f) {
      const uint32_t other = plan.lattice.neighbour(n, f);
      neighbour_[n][at(f)] = other == kNoCell ? nodes_ : other;
    }
  start_[nodes_] = begin_[nodes_] = kLongAgo;
  for (const PlanRound& round : plan.rounds)
    shape_.push_back({plan.arch.queue_depth, round.pipe, plan.rule.axes, plan.latency.interval,
                      plan.arch.narrow_memories ? round.beats : 0});
  for (auto& nodes : force_) nodes.resize(nodes_);
  if (rows_ != nullptr) where_.resize(rows_->first.size() - 1);
  for (auto& cycles : end_) cycles.resize(nodes_);
  for (auto* beats : {&halo_end_, &migrate_end_, &migrate_start_})
    for (auto& cycles : *beats) cycles.assign(nodes_ + 1, kLongAgo);
  for (int k = 0; k < threads_; ++k)
    scratch_.push_back({HitScratch(plan.arch.capacity, plan.arch.filter_lanes), {}});
}

void TimingModel::Impl::begin(const CellSlots& slots, std::span<const Leaving> leaving) {
  if (slots.first.size() != nodes_ + 1) throw std::invalid_argument("slots of another lattice");
  const size_t particles = slots.first[nodes_];
  for (const auto& x : slots.x)
    if (x.size() < particles) throw std::invalid_argument("slots without positions");
  if (rows_ != nullptr && slots.id.size() < particles) throw std::invalid_argument("slots without ids");
  for (uint32_t n = 0; n < nodes_; ++n) {
    const uint32_t count = slots.first[n + 1] - slots.first[n];
    if (count > static_cast<uint32_t>(plan_.arch.capacity))
      throw std::invalid_argument("a cell holds more than its capacity");
    if (steps_ > 0 && count != final_count_[n])
      throw std::invalid_argument("a cell does not hold what the step before left there");
  }
  for (const Leaving& l : leaving)
    if (l.cell >= nodes_ || l.slot >= slots.first[l.cell + 1] - slots.first[l.cell])
      throw std::invalid_argument("no such particle leaves");

  std::swap(x_, old_x_);
  std::swap(first_, old_first_);
  for (auto& x : x_) x.resize(particles + Places::kBeyond);
  if (rows_ != nullptr) id_ = slots.id;
  std::copy(slots.first.begin(), slots.first.end(), first_.begin());
  first_[nodes_ + 1] = first_[nodes_];
  for (uint32_t n = 0; n < nodes_; ++n) count_[n] = first_[n + 1] - first_[n];
  // Those that moved in the step before are what makes a node's particles others than they were.
  std::fill(changed_.begin(), changed_.end() - 1, steps_ == 0);
  migration_.mark(changed_);
  std::copy(count_.begin(), count_.end(), final_count_.begin());
  migration_.plan(final_count_, leaving);
  if (!links_.any() || !migration_.any()) return;
  for (int axis = 0; axis < axes_; ++axis) seen_[at(axis)].resize(migration_.departures(axis).size());
}

// Takes the node's particles, and notes whether they are where they were.
void TimingModel::Impl::place(const CellSlots& slots, uint32_t n) {
  const uint32_t first = first_[n], count = count_[n], old = old_first_[n];
  if (rows_ != nullptr) {
    for (uint32_t slot = 0; slot < count; ++slot) where_.at(id_[first + slot]) = {n, slot};
    moved_[n] = changed_[n];
    return;
  }
  bool moved = changed_[n] != 0;
  for (size_t a = 0; a < 3; ++a) {
    const int32_t* const x = slots.x[a].data() + first;
    moved = moved || !std::equal(x, x + count, old_x_[a].data() + old);
    std::copy_n(x, count, x_[a].data() + first);
  }
  moved_[n] = moved;
}

// The cycle that loads the end beat of a stream of these segments, by their records, whose phase begins in
// `start`.
int64_t TimingModel::Impl::sent(int axis, uint32_t n, int64_t start,
                                std::initializer_list<uint32_t> segments) {
  int64_t now = start;
  const uint8_t faces = faces_along(axis);
  for (const uint32_t records : segments)
    now = records == 0 || beats() == 0 ? now + 1 : links_.load(n, faces, now, records * beats()) + 1;
  return links_.load(n, faces, now, 1);
}

// The cycle in which the node sees the end beat that its neighbour loaded in `end`.
int64_t TimingModel::Impl::ended(const std::array<Cycles, 3>& end, int axis, uint32_t n, int side) const {
  const int face = 2 * axis + side;
  const uint32_t near = neighbour_[n][at(face)];
  return links_.cut(near, face ^ 1) ? links_.seen(near, face ^ 1) : end[at(axis)][near] + received_;
}

// The last cycle of EXCHANGE_a.
int64_t TimingModel::Impl::exchanged(int axis, uint32_t n) const {
  return std::max(
      {halo_end_[at(axis)][n] + kSent, ended(halo_end_, axis, n, 0), ended(halo_end_, axis, n, 1)});
}

void TimingModel::Impl::send_x(uint32_t n) { halo_end_[0][n] = sent(0, n, begin_[n], {count_[n]}); }

void TimingModel::Impl::exchange_x(const CellSlots& slots, uint32_t n) {
  if (round_ == 0) place(slots, n);
  const uint32_t own = count_[n], low = neighbour_[n][0], high = neighbour_[n][1];
  sent_y_[n] = own + count_[low] + count_[high];
  const int64_t end = end_of(Phase::exchange_x, n) = exchanged(0, n);
  halo_end_[1][n] = sent(1, n, end + 1, {own, count_[low], count_[high]});
}

void TimingModel::Impl::exchange_y(uint32_t n) {
  const auto& near = neighbour_[n];
  moved_x_[n] = moved_[n] | moved_[near[0]] | moved_[near[1]];
  const int64_t end = end_of(Phase::exchange_y, n) = exchanged(1, n);
  if (axes_ == 2) return;
  sent_z_[n] = sent_y_[n] + sent_y_[near[2]] + sent_y_[near[3]];
  halo_end_[2][n] =
      sent(2, n, end + 1, {count_[n], count_[near[0]], count_[near[1]], sent_y_[near[2]], sent_y_[near[3]]});
}

// Whether hits are those of the step before: the node and the 26 around hold what they held then, and where
// hits depend on positions, where they held it.
bool TimingModel::Impl::still(uint32_t n) const {
  unsigned moved = 0;
  for (const uint32_t at_z : {n, neighbour_[n][4], neighbour_[n][5]})
    moved |= moved_x_[at_z] | moved_x_[neighbour_[at_z][2]] | moved_x_[neighbour_[at_z][3]];
  return moved == 0;
}

int64_t TimingModel::Impl::force(uint32_t n, Scratch& scratch) {
  const int64_t begin = plan_.arch.overlap ? begin_[n] : end_of(Phase::exchange_z, n) + 1;
  Available available;
  for (int a = 0; a < 3; ++a) available[at(a)] = end_of(static_cast<Phase>(a), n) + 1 - begin;
  if (count_[n] == 0) return begin + idle_force_time(available, axes_);
  const Places places{{x_[0].data(), x_[1].data(), x_[2].data()},
                      first_.data(),
                      neighbour_.data(),
                      rows_,
                      id_.data(),
                      where_.data()};
  return begin + force_[at(round_)][n].time(filter_, places, n, shape_[at(round_)], available, still(n),
                                            scratch.hits, scratch.counters, events_[n]);
}

// Where an axis does not exist its phases end with those before them.
void TimingModel::Impl::exchange_z_to_update(uint32_t n, Scratch& scratch) {
  end_of(Phase::exchange_z, n) = axes_ == 3 ? exchanged(2, n) : end_of(Phase::exchange_y, n);
  const int64_t force_end = end_of(Phase::force, n) = force(n, scratch);
  const int64_t update =
      count_[n] == 0 ? 1 : (int64_t{count_[n]} - 1) * plan_.latency.stride + plan_.rounds[at(round_)].finish;
  const int64_t end = end_of(Phase::update, n) = force_end + update;
  begin_[n] = end + 1;
  if (round_ + 1 == rounds_) send_particles(0, n, end + 1);
}

void TimingModel::Impl::send_particles(int axis, uint32_t n, int64_t start) {
  migrate_start_[at(axis)][n] = start;
  migrate_end_[at(axis)][n] = links_.any() ? links_.load(n, faces_along(axis), scanned(axis, n, start), 1)
                                           : start + (migration_.any() ? migration_.scan(axis, n) : 0);
}

// With several devices: the first cycle after SCAN. A cycle for each slot, and loads for what leaves.
int64_t TimingModel::Impl::scanned(int axis, uint32_t n, int64_t start) {
  if (!migration_.any()) return start;
  const auto [first, departures] = migration_.departures(axis, n);
  int64_t now = start;
  uint32_t slot = 0;
  for (size_t k = 0; k < departures.size(); ++k) {
    const auto& [node, left, face] = departures[k];
    const int64_t last =
        links_.load(n, static_cast<uint8_t>(1u << face), now + left - slot, plan_.words.migrate_beats);
    seen_[at(axis)][first + k] = (links_.cut(n, face) ? links_.seen(n, face) : last + received_) + answered_;
    now = last + 1;
    slot = left + 1;
  }
  return now + migration_.scanned(axis, n).slots - slot;
}

// The cycle after TAKE_LOW (side 0) or TAKE_HIGH, whose first cycle is `now`.
int64_t TimingModel::Impl::taken(int axis, uint32_t n, int side, int64_t now) const {
  if (migration_.any())
    for (const auto& arrival : migration_.arrivals(axis, n, side))
      now = std::max(now, links_.any() ? seen_[at(axis)][arrival.departure]
                                       : migrate_start_[at(axis)][arrival.from] + arrival.after) +
            take_;
  return std::max(now, ended(migrate_end_, axis, n, side)) + 1;
}

void TimingModel::Impl::take_particles(int axis, uint32_t n) {
  const int64_t low = taken(axis, n, 0, migrate_end_[at(axis)][n] + 1);
  const int64_t next = taken(axis, n, 1, low);
  end_of(static_cast<Phase>(static_cast<int>(Phase::migrate_x) + axis), n) = next - 1;
  if (axis + 1 < axes_) send_particles(axis + 1, n, next);
}

// A relay reads what it sends along an axis once for both links, and whether there are links or not.
void TimingModel::Impl::count_records(uint32_t n) {
  MachineEvents& events = events_[n];
  for (int axis = 0; axis < axes_; ++axis) {
    const std::vector<uint32_t>& sent = axis == 0 ? count_ : axis == 1 ? sent_y_ : sent_z_;
    for (const PlanRound& round : plan_.rounds) {
      if (round.beats == 0) continue;
      events.relayed += sent[n];
      events.relayed_own += count_[n];
    }
    for (int face = 2 * axis; face < 2 * axis + 2; ++face) {
      const uint32_t near = neighbour_[n][at(face)];
      if (near == nodes_) continue;
      ++events.beats;  // the end of the particles
      for (const PlanRound& round : plan_.rounds) {
        if (round.beats > 0) halos_along(events, axis) += sent[near];
        events.beats += sent[n] * static_cast<uint64_t>(round.beats) + 1;
      }
    }
  }
}

void TimingModel::Impl::finish(uint32_t n, std::span<PhaseSpan> spans) {
  events_[n].updates += count_[n] * static_cast<uint64_t>(rounds_);
  count_records(n);
  migration_.count(n, axes_, events_[n]);
  write_spans(spans, n, start_[n], end_, rounds_, plan_.arch.overlap, events_[n]);
  start_[n] = end_of(Phase::migrate_z, n) + 1;
}

TimingModel::TimingModel(const Plan& plan, int threads) {
  if (plan.arch.halos == Halos::arrival)
    arrival_ = std::make_unique<ArrivalTiming>(plan, threads);
  else if (plan.bricks.one_cell())
    impl_ = std::make_unique<Impl>(plan, threads);
  else
    brick_ = std::make_unique<BrickTiming>(plan, threads);
}
TimingModel::~TimingModel() = default;

void TimingModel::step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) {
  if (brick_) return brick_->step(slots, leaving, spans);
  if (arrival_) return arrival_->step(slots, leaving, spans);
  Impl& m = *impl_;
  if (!spans.empty() && spans.size() != size_t{m.nodes_} * m.end_.size())
    throw std::invalid_argument("spans of another lattice");
  m.begin(slots, leaving);
  const auto nodes = static_cast<int64_t>(m.nodes_);
  const auto work = nodes + 2 * int64_t{m.first_[m.nodes_]};
  const int threads = static_cast<int>(std::clamp<int64_t>(work / kWorkPerThread, 1, m.threads_));
  // Busy nodes cost many times what empty ones do: small shares, on demand.
  const int64_t share = std::clamp<int64_t>(nodes / (16 * threads), 1, 64);
  const auto for_all = [&](const auto& part) {
    const auto range = [&](size_t begin, size_t end) {
      for (size_t n = begin; n < end; ++n) part(static_cast<uint32_t>(n));
    };
    for_each_range(m.nodes_, 1, range, threads);
  };
  std::copy(m.start_.begin(), m.start_.end(), m.begin_.begin());
  for (m.round_ = 0;; ++m.round_) {
    for_all([&](uint32_t n) { m.send_x(n); });
    for_all([&](uint32_t n) { m.exchange_x(slots, n); });
    for_all([&](uint32_t n) { m.exchange_y(n); });
    for_each_part(static_cast<size_t>((nodes + share - 1) / share), threads, [&](size_t k, int member) {
      const auto first = static_cast<int64_t>(k) * share;
      for (int64_t n = first; n < std::min(nodes, first + share); ++n)
        m.exchange_z_to_update(static_cast<uint32_t>(n), m.scratch_[at(member)]);
    });
    if (m.round_ + 1 == m.rounds_) break;
  }
  const int last = m.axes_ - 1;
  for (int axis = 0; axis < last; ++axis) for_all([&](uint32_t n) { m.take_particles(axis, n); });
  for_all([&](uint32_t n) {
    m.take_particles(last, n);
    if (last < 2) m.end_of(Phase::migrate_z, n) = m.end_of(Phase::migrate_y, n);
    m.finish(n, spans);
  });
  ++m.steps_;
  for (Scratch& s : m.scratch_) {
    m.counters_.busy += s.counters.busy;
    m.counters_.filtered += s.counters.filtered;
    m.counters_.walked += s.counters.walked;
    s.counters = {};
  }
}

uint64_t TimingModel::cycles(const CellSlots& slots) const {
  if (brick_) return brick_->cycles(slots);
  if (arrival_) return arrival_->cycles(slots);
  const Impl& m = *impl_;
  if (slots.first.size() != m.nodes_ + 1) throw std::invalid_argument("slots of another lattice");
  uint64_t idle = 0;  // the last node's first cycle of IDLE
  for (uint32_t n = 0; n < m.nodes_; ++n)
    idle = std::max(idle,
                    static_cast<uint64_t>(m.start_[n]) + std::max(1u, slots.first[n + 1] - slots.first[n]));
  return idle + 1;
}

std::vector<uint64_t> TimingModel::starts() const {
  if (brick_) return brick_->starts();
  if (arrival_) return arrival_->starts();
  std::vector<uint64_t> starts(impl_->start_.begin(), impl_->start_.end() - 1);
  impl_->links_.save(starts);
  return starts;
}

void TimingModel::resume(std::span<const uint64_t> starts) {
  if (brick_) return brick_->resume(starts);
  if (arrival_) return arrival_->resume(starts);
  const size_t nodes = impl_->nodes_;
  if (starts.size() != nodes + impl_->links_.saved())
    throw std::invalid_argument("starts of another lattice");
  std::copy_n(starts.begin(), nodes, impl_->start_.begin());
  impl_->links_.load_state(starts.subspan(nodes));
  impl_->steps_ = 0;  // the next step's particles are not those of the last one
}

std::span<const MachineEvents> TimingModel::events() const {
  return brick_ ? brick_->events() : arrival_ ? arrival_->events() : impl_->events_;
}

const TimingCounters& TimingModel::counters() const {
  return brick_ ? brick_->counters() : arrival_ ? arrival_->counters() : impl_->counters_;
}

}  // namespace cuboct::emu
