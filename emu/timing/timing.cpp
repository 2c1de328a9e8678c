// SPDX-License-Identifier: MIT
#include "emu/timing/timing.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "emu/timing/arrival_timing.h"
#include "emu/timing/brick_timing.h"
#include "emu/timing/cycles.h"
#include "emu/timing/force_time.h"
#include "emu/timing/hits.h"
#include "emu/timing/node_timing.h"
#include "emu/timing/phase_spans.h"
#include "model/program/integer_program.h"

namespace cuboct::emu {
namespace {

using Cycles = std::vector<int64_t>;  // by node

struct Scratch {
  HitScratch hits;
  TimingCounters counters;
};

// Of nodes that serve one cell each, phase by phase.
class PhaseTiming final : public CellTiming {
 public:
  PhaseTiming(const Plan& plan, int threads);
  void step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) override;

 private:
  void begin(const CellSlots& slots, std::span<const Leaving> leaving, std::span<const PhaseSpan> spans);
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
  int64_t taken(int axis, uint32_t n, int side, int64_t now) const;
  void count_records(uint32_t n);

  const int rounds_;
  const graph::BondRows* const rows_;  // of a bonded rule
  std::vector<ForceShape> shape_;      // by round
  const Filter filter_;
  const int64_t take_;  // cycles of TAKE per particle

  // Of the step, nodes + 1 each: the one that does not exist is empty.
  std::array<std::vector<int32_t>, 3> x_, old_x_;  // at its start, and at that of the step before
  std::vector<uint32_t> first_, old_first_;        // one more
  std::vector<uint32_t> id_;                       // of a bonded rule
  std::vector<NodeSlot> where_;                    // of a bonded rule, by id
  std::vector<uint8_t> changed_;  // other particles than in the step before, or another order
  // ... or another position, where hits depend on it; there, or in a neighbour along x too.
  std::vector<uint8_t> moved_, moved_x_;
  std::vector<uint32_t> sent_y_, sent_z_;  // records that it sends along y, z

  int round_ = 0;  // that is looked at
  Cycles begin_;   // its first cycle
  std::array<Cycles, 3> halo_end_, migrate_end_,
      migrate_start_;                          // [axis] cycle that loads the end beat; first cycle
  std::vector<std::vector<NodeForce>> force_;  // by round, then node
  std::vector<Scratch> scratch_;               // by thread
};

PhaseTiming::PhaseTiming(const Plan& plan, int threads)
    : CellTiming(plan, threads, plan.arch.narrow_memories ? 0 : kAnswered),
      rounds_(static_cast<int>(plan.rounds.size())),
      rows_(plan.program ? plan.program->rows.get() : nullptr),
      filter_(plan.rule, plan.arch.filter_lanes, plan.arch.force_pipes),
      take_(plan.arch.narrow_memories ? plan.words.migrate_beats + 2 : 1),
      first_(nodes_ + 2),
      old_first_(nodes_ + 2),
      changed_(nodes_ + 1),
      moved_(nodes_ + 1),
      moved_x_(nodes_ + 1),
      sent_y_(nodes_ + 1),
      sent_z_(nodes_ + 1),
      begin_(nodes_ + 1),
      force_(plan.rounds.size()) {
  begin_[nodes_] = kLongAgo;
  for (const PlanRound& round : plan.rounds)
    shape_.push_back({plan.arch.queue_depth, round.pipe, plan.rule.axes, plan.latency.interval,
                      plan.arch.narrow_memories ? round.beats : 0});
  for (auto& nodes : force_) nodes.resize(nodes_);
  if (rows_ != nullptr) where_.resize(rows_->first.size() - 1);
  for (auto* beats : {&halo_end_, &migrate_end_, &migrate_start_})
    for (auto& cycles : *beats) cycles.assign(nodes_ + 1, kLongAgo);
  for (int k = 0; k < threads_; ++k)
    scratch_.push_back({HitScratch(plan.arch.capacity, plan.arch.filter_lanes), {}});
}

void PhaseTiming::begin(const CellSlots& slots, std::span<const Leaving> leaving,
                        std::span<const PhaseSpan> spans) {
  take(slots, leaving, spans);
  const size_t particles = slots.first[nodes_];
  if (rows_ != nullptr && slots.id.size() < particles) throw std::invalid_argument("slots without ids");
  std::swap(x_, old_x_);
  std::swap(first_, old_first_);
  for (auto& x : x_) x.resize(particles + Places::kBeyond);
  if (rows_ != nullptr) id_ = slots.id;
  std::copy(slots.first.begin(), slots.first.end(), first_.begin());
  first_[nodes_ + 1] = first_[nodes_];
  // Those that moved in the step before are what makes a node's particles others than they were.
  std::fill(changed_.begin(), changed_.end() - 1, steps_ == 0);
  migration_.mark(changed_);
  plan_migration(leaving);
}

// Takes the node's particles, and notes whether they are where they were.
void PhaseTiming::place(const CellSlots& slots, uint32_t n) {
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
int64_t PhaseTiming::sent(int axis, uint32_t n, int64_t start, std::initializer_list<uint32_t> segments) {
  int64_t now = start;
  const uint8_t faces = faces_along(axis);
  for (const uint32_t records : segments)
    now = records == 0 || beats() == 0 ? now + 1 : links_.load(n, faces, now, records * beats()) + 1;
  return links_.load(n, faces, now, 1);
}

// The cycle in which the node sees the end beat that its neighbour loaded in `end`.
int64_t PhaseTiming::ended(const std::array<Cycles, 3>& end, int axis, uint32_t n, int side) const {
  const int face = 2 * axis + side;
  const uint32_t near = neighbour_[n][at(face)];
  return links_.cut(near, face ^ 1) ? links_.seen(near, face ^ 1) : end[at(axis)][near] + received_;
}

// The last cycle of EXCHANGE_a.
int64_t PhaseTiming::exchanged(int axis, uint32_t n) const {
  return std::max(
      {halo_end_[at(axis)][n] + kSent, ended(halo_end_, axis, n, 0), ended(halo_end_, axis, n, 1)});
}

void PhaseTiming::send_x(uint32_t n) { halo_end_[0][n] = sent(0, n, begin_[n], {count_[n]}); }

void PhaseTiming::exchange_x(const CellSlots& slots, uint32_t n) {
  if (round_ == 0) place(slots, n);
  const uint32_t own = count_[n], low = neighbour_[n][0], high = neighbour_[n][1];
  sent_y_[n] = own + count_[low] + count_[high];
  const int64_t end = end_of(Phase::exchange_x, n) = exchanged(0, n);
  halo_end_[1][n] = sent(1, n, end + 1, {own, count_[low], count_[high]});
}

void PhaseTiming::exchange_y(uint32_t n) {
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
bool PhaseTiming::still(uint32_t n) const {
  unsigned moved = 0;
  for (const uint32_t at_z : {n, neighbour_[n][4], neighbour_[n][5]})
    moved |= moved_x_[at_z] | moved_x_[neighbour_[at_z][2]] | moved_x_[neighbour_[at_z][3]];
  return moved == 0;
}

int64_t PhaseTiming::force(uint32_t n, Scratch& scratch) {
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
void PhaseTiming::exchange_z_to_update(uint32_t n, Scratch& scratch) {
  end_of(Phase::exchange_z, n) = axes_ == 3 ? exchanged(2, n) : end_of(Phase::exchange_y, n);
  const int64_t force_end = end_of(Phase::force, n) = force(n, scratch);
  const int64_t update =
      count_[n] == 0 ? 1 : (int64_t{count_[n]} - 1) * plan_.latency.stride + plan_.rounds[at(round_)].finish;
  const int64_t end = end_of(Phase::update, n) = force_end + update;
  begin_[n] = end + 1;
  if (round_ + 1 == rounds_) send_particles(0, n, end + 1);
}

void PhaseTiming::send_particles(int axis, uint32_t n, int64_t start) {
  migrate_start_[at(axis)][n] = start;
  migrate_end_[at(axis)][n] = links_.load(n, faces_along(axis), scanned(axis, n, start), 1);
}

// The cycle after TAKE_LOW (side 0) or TAKE_HIGH, whose first cycle is `now`.
int64_t PhaseTiming::taken(int axis, uint32_t n, int side, int64_t now) const {
  if (migration_.any())
    for (const auto& arrival : migration_.arrivals(axis, n, side))
      now = std::max(now, links_.any() ? seen_[at(axis)][arrival.departure]
                                       : migrate_start_[at(axis)][arrival.from] + arrival.after) +
            take_;
  return std::max(now, ended(migrate_end_, axis, n, side)) + 1;
}

void PhaseTiming::take_particles(int axis, uint32_t n) {
  const int64_t low = taken(axis, n, 0, migrate_end_[at(axis)][n] + 1);
  const int64_t next = taken(axis, n, 1, low);
  end_of(static_cast<Phase>(static_cast<int>(Phase::migrate_x) + axis), n) = next - 1;
  if (axis + 1 < axes_) send_particles(axis + 1, n, next);
}

// A relay reads what it sends along an axis once for both links, and whether there are links or not.
void PhaseTiming::count_records(uint32_t n) {
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

void PhaseTiming::finish(uint32_t n, std::span<PhaseSpan> spans) {
  events_[n].updates += count_[n] * static_cast<uint64_t>(rounds_);
  count_records(n);
  migration_.count(n, axes_, events_[n]);
  write_spans(spans, n, start_[n], end_, rounds_, plan_.arch.overlap, events_[n]);
  start_[n] = end_of(Phase::migrate_z, n) + 1;
}

void PhaseTiming::step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) {
  begin(slots, leaving, spans);
  const auto work = int64_t{nodes_} + 2 * int64_t{first_[nodes_]};
  const int threads = static_cast<int>(std::clamp<int64_t>(work / kWorkPerThread, 1, threads_));
  std::copy(start_.begin(), start_.end(), begin_.begin());
  for (round_ = 0;; ++round_) {
    for_all(threads, [&](uint32_t n) { send_x(n); });
    for_all(threads, [&](uint32_t n) { exchange_x(slots, n); });
    for_all(threads, [&](uint32_t n) { exchange_y(n); });
    for_all_busy(threads, [&](uint32_t n, int member) { exchange_z_to_update(n, scratch_[at(member)]); });
    if (round_ + 1 == rounds_) break;
  }
  const int last = axes_ - 1;
  for (int axis = 0; axis < last; ++axis) for_all(threads, [&](uint32_t n) { take_particles(axis, n); });
  for_all(threads, [&](uint32_t n) {
    take_particles(last, n);
    if (last < 2) end_of(Phase::migrate_z, n) = end_of(Phase::migrate_y, n);
    finish(n, spans);
  });
  ++steps_;
  for (Scratch& s : scratch_) {
    counters_.busy += s.counters.busy;
    counters_.filtered += s.counters.filtered;
    counters_.walked += s.counters.walked;
    s.counters = {};
  }
}

std::unique_ptr<NodeTiming> timing_of(const Plan& plan, int threads) {
  if (plan.arch.halos == Halos::arrival) return std::make_unique<ArrivalTiming>(plan, threads);
  if (plan.bricks.one_cell()) return std::make_unique<PhaseTiming>(plan, threads);
  return std::make_unique<BrickTiming>(plan, threads);
}

}  // namespace

TimingModel::TimingModel(const Plan& plan, int threads) : nodes_(timing_of(plan, threads)) {}
TimingModel::~TimingModel() = default;

void TimingModel::step(const CellSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) {
  nodes_->step(slots, leaving, spans);
}
uint64_t TimingModel::cycles(const CellSlots& slots) const { return nodes_->cycles(slots); }
std::vector<uint64_t> TimingModel::starts() const { return nodes_->starts(); }
void TimingModel::resume(std::span<const uint64_t> starts) { nodes_->resume(starts); }
std::span<const MachineEvents> TimingModel::events() const { return nodes_->events(); }
const TimingCounters& TimingModel::counters() const { return nodes_->counters(); }

}  // namespace cuboct::emu
