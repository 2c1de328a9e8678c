// SPDX-License-Identifier: MIT
#include "emu/timing/node_timing.h"

#include <stdexcept>

#include "emu/timing/cycles.h"

namespace cuboct::emu {

NodeTiming::NodeTiming(const Plan& plan, int threads)
    : plan_(plan),
      cells_(plan.lattice.size()),
      nodes_(plan.nodes()),
      axes_(plan.rule.axes),
      threads_(threads > 0 ? threads : usable_cores()),
      received_(kReceived + plan.link.latency),
      links_(plan),
      count_(cells_ + 1),
      final_count_(cells_ + 1),
      start_(nodes_ + 1),
      end_(at(phases_of(static_cast<int>(plan.rounds.size())))),
      events_(nodes_) {
  start_[nodes_] = kLongAgo;
  for (auto& cycles : end_) cycles.resize(nodes_);
}

void NodeTiming::take(const CellSlots& slots, std::span<const Leaving> leaving,
                      std::span<const PhaseSpan> spans) {
  if (!spans.empty() && spans.size() != nodes_ * end_.size())
    throw std::invalid_argument("spans of another lattice");
  if (slots.first.size() != cells_ + 1) throw std::invalid_argument("slots of another lattice");
  for (const auto& x : slots.x)
    if (x.size() < slots.first[cells_]) throw std::invalid_argument("slots without positions");
  for (uint32_t c = 0; c < cells_; ++c) {
    count_[c] = slots.first[c + 1] - slots.first[c];
    if (count_[c] > static_cast<uint32_t>(plan_.arch.capacity))
      throw std::invalid_argument("a cell holds more than its capacity");
    if (steps_ > 0 && count_[c] != final_count_[c])
      throw std::invalid_argument("a cell does not hold what the step before left there");
  }
  for (const Leaving& l : leaving)
    if (l.cell >= cells_ || l.slot >= count_[l.cell]) throw std::invalid_argument("no such particle leaves");
  final_count_ = count_;
}

uint64_t NodeTiming::cycles(const CellSlots& slots) const {
  if (slots.first.size() != cells_ + 1) throw std::invalid_argument("slots of another lattice");
  int64_t idle = 0;  // the last node's first cycle of IDLE
  for (uint32_t n = 0; n < nodes_; ++n) idle = std::max(idle, start_[n] + walk(n, slots.first.data()));
  return static_cast<uint64_t>(idle) + 1;
}

std::vector<uint64_t> NodeTiming::starts() const {
  std::vector<uint64_t> starts(start_.begin(), start_.end() - 1);
  links_.save(starts);
  return starts;
}

void NodeTiming::resume(std::span<const uint64_t> starts) {
  if (starts.size() != nodes_ + links_.saved()) throw std::invalid_argument("starts of another lattice");
  std::copy_n(starts.begin(), nodes_, start_.begin());
  links_.load_state(starts.subspan(nodes_));
  steps_ = 0;  // the next step's particles are not those of the last one
}

CellTiming::CellTiming(const Plan& plan, int threads, int64_t answered)
    : NodeTiming(plan, threads),
      answered_(answered),
      neighbour_(nodes_ + 1),
      migration_(plan.lattice, plan.words.migrate_beats, static_cast<int>(received_ + answered)) {
  neighbour_[nodes_].fill(nodes_);
  for (uint32_t n = 0; n < nodes_; ++n)
    for (int f = 0; f < kFaces; ++f) {
      const uint32_t near = plan.lattice.neighbour(n, f);
      neighbour_[n][at(f)] = near == kNoCell ? nodes_ : near;
    }
}

void CellTiming::plan_migration(std::span<const Leaving> leaving) {
  migration_.plan(final_count_, leaving);
  if (!links_.any() || !migration_.any()) return;
  for (int axis = 0; axis < axes_; ++axis) seen_[at(axis)].resize(migration_.departures(axis).size());
}

int64_t CellTiming::scanned(int axis, uint32_t n, int64_t start) {
  if (!migration_.any()) return start;
  if (!links_.any()) return start + migration_.scan(axis, n);
  const auto [first, departures] = migration_.departures(axis, n);
  int64_t now = start, slot = 0;
  for (size_t k = 0; k < departures.size(); ++k) {
    const auto& [node, left, face] = departures[k];
    const int64_t last =
        links_.load(n, static_cast<uint8_t>(1u << face), now + left - slot, plan_.words.migrate_beats);
    seen_[at(axis)][first + k] = (links_.cut(n, face) ? links_.seen(n, face) : last + received_) + answered_;
    now = last + 1;
    slot = int64_t{left} + 1;
  }
  return now + migration_.scanned(axis, n).slots - slot;
}

}  // namespace cuboct::emu
