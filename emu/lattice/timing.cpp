// SPDX-License-Identifier: MIT
#include "emu/lattice/timing.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "emu/lattice/force_time.h"
#include "emu/lattice/hits.h"
#include "emu/lattice/migrate_time.h"

namespace cuboct::emu {
namespace {

// An end beat loaded in cycle t is seen by its sender (`sent`) in t + 1, by its receiver in t + 2: through the
// sender's output register and the receiver's.
constexpr int64_t kSent = 1, kReceived = 2;
// The end beat of a face without link: seen since long before.
constexpr int64_t kLongAgo = INT64_MIN / 4;
// Elements that vector loads may read beyond the last particle.
constexpr size_t kBeyond = 64;
// Nodes that are worth a thread: its share of a step is then longer than the barriers of the step.
constexpr uint32_t kNodesPerThread = 8;

using Cycles = std::vector<int64_t>;  // by node

constexpr size_t at(int index) { return static_cast<size_t>(index); }
constexpr size_t at(Phase phase) { return static_cast<size_t>(phase); }

struct Scratch {
  HitScratch hits;
  std::vector<int64_t> popped;
  TimingCounters counters;
};

}  // namespace

struct TimingModel::Impl {
  Impl(const Plan& plan, int threads);

  void take(const NodeSlots& slots, std::span<const Leaving> leaving);
  // One node's part of a phase; a phase of a node reads what the phases before left of its neighbours.
  void send_x(uint32_t n);
  void exchange_x(uint32_t n);
  void exchange_y(uint32_t n);
  void exchange_z_to_update(uint32_t n, Scratch& scratch);
  void take_particles(int axis, uint32_t n);
  void write(uint32_t n, std::span<PhaseSpan> spans) const;

  int64_t stream(int64_t records) const { return records == 0 ? 1 : records * halo_beats_; }
  int64_t exchanged(int axis, uint32_t n) const;
  int64_t force(uint32_t n, Scratch& scratch);
  void send_particles(int axis, uint32_t n, int64_t start);
  int64_t taken(int axis, uint32_t n, int side, int64_t now) const;

  const Plan& plan_;
  const uint32_t nodes_;
  const int threads_;
  const int64_t halo_beats_;
  const ForceShape shape_;
  Filter filter_;
  std::vector<std::array<uint32_t, 6>> neighbour_;  // nodes + 1; number `nodes_` where there is none
  Migration migration_;

  // Of the step: particles at its start.
  std::array<std::vector<int32_t>, 3> x_;
  std::vector<uint32_t> first_;                // nodes + 2
  std::vector<uint32_t> count_, final_count_;  // nodes + 1, nodes: at the start, at the end of the step

  std::vector<uint64_t> start_;             // the step's first cycle
  std::array<Cycles, kPhases> end_;         // the phases' last cycles
  std::array<Cycles, 3> halo_end_beat_, migrate_end_beat_;  // [axis] cycle that loads it; nodes + 1
  std::array<Cycles, 3> migrate_start_;
  std::vector<int64_t> sent_y_;  // records sent along y; nodes + 1
  std::vector<Scratch> scratch_;            // by thread
  TimingCounters counters_;
};

TimingModel::Impl::Impl(const Plan& plan, int threads)
    : plan_(plan),
      nodes_(plan.lattice.size()),
      threads_(threads > 0 ? threads : omp_get_num_procs()),
      halo_beats_(plan.words.halo_beats),
      shape_{plan.arch.queue_depth, plan.latency.pipe},
      filter_{PlanarTest(plan.rule), plan.arch.filter_lanes, {}},
      neighbour_(nodes_ + 1),
      migration_(plan.lattice, plan.words.migrate_beats),
      first_(nodes_ + 2),
      count_(nodes_ + 1),
      final_count_(nodes_),
      start_(nodes_),
      sent_y_(nodes_ + 1) {
  for (int hits = 0; hits <= plan.arch.filter_lanes; ++hits)
    filter_.service[at(hits)] =
        static_cast<uint8_t>((hits + plan.arch.force_pipes - 1) / plan.arch.force_pipes);
  neighbour_[nodes_].fill(nodes_);
  for (uint32_t n = 0; n < nodes_; ++n)
    for (int f = 0; f < kFaces; ++f) {
      const uint32_t other = plan.lattice.neighbour(n, f);
      neighbour_[n][at(f)] = other == kNoNode ? nodes_ : other;
    }
  for (auto& cycles : end_) cycles.resize(nodes_);
  for (auto* beats : {&halo_end_beat_, &migrate_end_beat_})
    for (auto& cycles : *beats) {
      cycles.resize(nodes_ + 1);
      cycles[nodes_] = kLongAgo;
    }
  for (auto& cycles : migrate_start_) cycles.resize(nodes_);

  const auto capacity = static_cast<size_t>(plan.arch.capacity), lanes = at(plan.arch.filter_lanes);
  scratch_.resize(at(threads_));
  for (Scratch& s : scratch_) {
    for (auto& x : s.hits.x) x.resize(27 * capacity + kBeyond);
    s.hits.hits.resize(27 * capacity + kBeyond);
    s.hits.service.resize(27 * capacity * ((capacity + lanes - 1) / lanes));
  }
}

void TimingModel::Impl::take(const NodeSlots& slots, std::span<const Leaving> leaving) {
  if (slots.first.size() != nodes_ + 1) throw std::invalid_argument("slots of another lattice");
  const size_t particles = slots.first[nodes_];
  for (int a = 0; a < 3; ++a) {
    if (slots.x[at(a)].size() < particles) throw std::invalid_argument("slots without positions");
    x_[at(a)].resize(particles + kBeyond);
    std::copy_n(slots.x[at(a)].begin(), particles, x_[at(a)].begin());
  }
  std::copy(slots.first.begin(), slots.first.end(), first_.begin());
  first_[nodes_ + 1] = first_[nodes_];
  for (uint32_t n = 0; n < nodes_; ++n) {
    count_[n] = first_[n + 1] - first_[n];
    if (count_[n] > static_cast<uint32_t>(plan_.arch.capacity))
      throw std::invalid_argument("a node holds more than its capacity");
  }
  std::copy_n(count_.begin(), nodes_, final_count_.begin());
  for (const Leaving& l : leaving)
    if (l.node >= nodes_ || l.slot >= count_[l.node]) throw std::invalid_argument("no such particle leaves");
  migration_.plan(final_count_, leaving);
}

void TimingModel::Impl::send_x(uint32_t n) {
  halo_end_beat_[0][n] = static_cast<int64_t>(start_[n]) + stream(count_[n]);
}

// The last cycle of EXCHANGE_a.
int64_t TimingModel::Impl::exchanged(int axis, uint32_t n) const {
  const Cycles& beat = halo_end_beat_[at(axis)];
  const auto& near = neighbour_[n];
  return std::max({beat[n] + kSent, beat[near[at(2 * axis)]] + kReceived, beat[near[at(2 * axis + 1)]] + kReceived});
}

void TimingModel::Impl::exchange_x(uint32_t n) {
  const int64_t own = count_[n], low = count_[neighbour_[n][0]], high = count_[neighbour_[n][1]];
  sent_y_[n] = own + low + high;
  const int64_t end = end_[at(Phase::exchange_x)][n] = exchanged(0, n);
  halo_end_beat_[1][n] = end + 1 + stream(own) + stream(low) + stream(high);
}

void TimingModel::Impl::exchange_y(uint32_t n) {
  const auto& near = neighbour_[n];
  const int64_t x = stream(count_[n]) + stream(count_[near[0]]) + stream(count_[near[1]]);
  const int64_t end = end_[at(Phase::exchange_y)][n] = exchanged(1, n);
  halo_end_beat_[2][n] = end + 1 + x + stream(sent_y_[near[2]]) + stream(sent_y_[near[3]]);
}

int64_t TimingModel::Impl::force(uint32_t n, Scratch& scratch) {
  const int64_t begin = plan_.arch.overlap ? static_cast<int64_t>(start_[n])
                                           : end_[at(Phase::exchange_z)][n] + 1;
  Available available;
  for (int a = 0; a < 3; ++a) available[at(a)] = end_[at(a)][n] + 1 - begin;
  if (count_[n] == 0) return begin + idle_force_time(available);
  const Places places{{x_[0].data(), x_[1].data(), x_[2].data()}, first_.data(), neighbour_.data()};
  const ForceWork work = filter_node(filter_, places, n, scratch.hits);
  ++scratch.counters.filtered;
  ++scratch.counters.streamed;
  return begin + force_time(shape_, work, available, scratch.popped);
}

void TimingModel::Impl::exchange_z_to_update(uint32_t n, Scratch& scratch) {
  end_[at(Phase::exchange_z)][n] = exchanged(2, n);
  const int64_t force_end = end_[at(Phase::force)][n] = force(n, scratch);
  const int64_t update = count_[n] == 0 ? 1 : int64_t{count_[n]} - 1 + plan_.latency.update;
  const int64_t end = end_[at(Phase::update)][n] = force_end + update;
  send_particles(0, n, end + 1);
}

void TimingModel::Impl::send_particles(int axis, uint32_t n, int64_t start) {
  migrate_start_[at(axis)][n] = start;
  migrate_end_beat_[at(axis)][n] = start + (migration_.any() ? migration_.scan(axis, n) : 0);
}

// The cycle after TAKE_LOW (side 0) or TAKE_HIGH, whose first cycle is `now`.
int64_t TimingModel::Impl::taken(int axis, uint32_t n, int side, int64_t now) const {
  if (migration_.any())
    for (const auto& arrival : migration_.arrivals(axis, n, side))
      now = std::max(now, migrate_start_[at(axis)][arrival.from] + arrival.after) + 1;
  const uint32_t near = neighbour_[n][at(2 * axis + side)];
  return std::max(now, migrate_end_beat_[at(axis)][near] + kReceived) + 1;
}

void TimingModel::Impl::take_particles(int axis, uint32_t n) {
  const int64_t low = taken(axis, n, 0, migrate_end_beat_[at(axis)][n] + 1);
  const int64_t next = taken(axis, n, 1, low);
  end_[at(Phase::migrate_x) + at(axis)][n] = next - 1;
  if (axis < 2) send_particles(axis + 1, n, next);
}

void TimingModel::Impl::write(uint32_t n, std::span<PhaseSpan> spans) const {
  PhaseSpan* const span = spans.data() + size_t{n} * kPhases;
  uint64_t start = start_[n];
  for (size_t p = 0; p < kPhases; ++p) {
    const auto end = static_cast<uint64_t>(end_[p][n]);
    span[p] = {p == at(Phase::force) && plan_.arch.overlap ? start_[n] : start, end};
    start = end + 1;
  }
}

TimingModel::TimingModel(const Plan& plan, int threads) : impl_(std::make_unique<Impl>(plan, threads)) {}
TimingModel::~TimingModel() = default;

void TimingModel::step(const NodeSlots& slots, std::span<const Leaving> leaving, std::span<PhaseSpan> spans) {
  Impl& m = *impl_;
  if (!spans.empty() && spans.size() != size_t{m.nodes_} * kPhases)
    throw std::invalid_argument("spans of another lattice");
  m.take(slots, leaving);
  const auto nodes = static_cast<int64_t>(m.nodes_);
  const int threads =
      static_cast<int>(std::clamp<int64_t>(nodes / kNodesPerThread, 1, m.threads_));
#pragma omp parallel num_threads(threads)
  {
    Scratch& scratch = m.scratch_[at(omp_get_thread_num())];
    const auto all = [nodes](const auto& part) {
#pragma omp for schedule(static)
      for (int64_t n = 0; n < nodes; ++n) part(static_cast<uint32_t>(n));
    };
    all([&](uint32_t n) { m.send_x(n); });
    all([&](uint32_t n) { m.exchange_x(n); });
    all([&](uint32_t n) { m.exchange_y(n); });
    // Busy nodes cost many times what empty ones do.
#pragma omp for schedule(dynamic, 16)
    for (int64_t n = 0; n < nodes; ++n) m.exchange_z_to_update(static_cast<uint32_t>(n), scratch);
    for (int axis = 0; axis < 3; ++axis) all([&](uint32_t n) { m.take_particles(axis, n); });
    all([&](uint32_t n) {
      if (!spans.empty()) m.write(n, spans);
      m.start_[n] = static_cast<uint64_t>(m.end_[at(Phase::migrate_z)][n]) + 1;
    });
  }
  m.counters_.node_steps += m.nodes_;
  for (Scratch& s : m.scratch_) {
    m.counters_.filtered += s.counters.filtered;
    m.counters_.streamed += s.counters.streamed;
    s.counters = {};
  }
}

uint64_t TimingModel::cycles(const NodeSlots& slots) const {
  const Impl& m = *impl_;
  if (slots.first.size() != m.nodes_ + 1) throw std::invalid_argument("slots of another lattice");
  uint64_t idle = 0;  // the last node's first cycle of IDLE
  for (uint32_t n = 0; n < m.nodes_; ++n)
    idle = std::max(idle, m.start_[n] + std::max(1u, slots.first[n + 1] - slots.first[n]));
  return idle + 1;
}

const std::vector<uint64_t>& TimingModel::starts() const { return impl_->start_; }

void TimingModel::resume(std::span<const uint64_t> starts) {
  if (starts.size() != impl_->nodes_) throw std::invalid_argument("starts of another lattice");
  std::copy(starts.begin(), starts.end(), impl_->start_.begin());
}

const TimingCounters& TimingModel::counters() const { return impl_->counters_; }

}  // namespace cuboct::emu
