// SPDX-License-Identifier: MIT
#include "emu/timing/migrate_time.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "emu/timing/cycles.h"

namespace cuboct::emu {
Migration::Migration(const Lattice& lattice, int beats, int on_the_way)
    : lattice_(lattice), beats_(beats), on_the_way_(on_the_way), leaving_bits_(lattice.size()) {
  for (auto& scan : scan_) scan.resize(lattice.size());
  for (auto& group : group_) group.assign(lattice.size(), -1);
}

std::span<const Migration::Arrival> Migration::arrivals(int axis, uint32_t node, int side) const {
  const int32_t group = group_[at(axis)][node];
  if (group < 0) return {};
  const auto& range = groups_[static_cast<size_t>(group)];
  const auto from = range[static_cast<size_t>(side)], to = range[static_cast<size_t>(side) + 1];
  return {arrivals_.data() + from, to - from};
}

Migration::OfNode Migration::departures(int axis, uint32_t node) const {
  const auto& all = departures_[at(axis)];
  const auto begin = std::ranges::lower_bound(all, node, {}, &Departure::node);
  const auto end = std::ranges::upper_bound(all, node, {}, &Departure::node);
  return {static_cast<uint32_t>(begin - all.begin()), {begin, end}};
}

void Migration::count(uint32_t node, int axes, MachineEvents& events) const {
  if (!any_) return;
  for (int axis = 0; axis < axes; ++axis) {
    const Scan& s = scanned(axis, node);
    events.scanned += static_cast<uint64_t>(s.slots);
    events.left += static_cast<uint64_t>(s.left);
    events.beats += static_cast<uint64_t>(s.left) * static_cast<uint64_t>(beats_);
    for (int side = 0; side < 2; ++side) events.moved += arrivals(axis, node, side).size();
  }
}

void Migration::mark(std::span<uint8_t> changed) const {
  for (const auto& nodes : leaving_)
    for (const uint32_t node : nodes) changed[node] = 1;
  for (const auto& nodes : received_)
    for (const uint32_t node : nodes) changed[node] = 1;
}

void Migration::forget() {
  for (int axis = 0; axis < 3; ++axis) {
    for (const uint32_t node : leaving_[at(axis)]) scan_[at(axis)][node] = {}, leaving_bits_[node] = 0;
    for (const uint32_t node : received_[at(axis)]) group_[at(axis)][node] = -1;
    leaving_[at(axis)].clear();
    received_[at(axis)].clear();
    departures_[at(axis)].clear();
  }
  movers_.clear();
  groups_.clear();
  arrivals_.clear();
}

void Migration::set_leaving(uint32_t node, int axis) {
  const auto bit = static_cast<uint8_t>(1u << axis);
  if ((leaving_bits_[node] & bit) != 0) return;
  leaving_bits_[node] |= bit;
  leaving_[at(axis)].push_back(node);
}

void Migration::plan(std::span<uint32_t> count, std::span<const Leaving> leaving) {
  if (any_) forget();
  any_ = !leaving.empty();
  if (!any_) return;
  for (const Leaving& l : leaving) {
    movers_.push_back({l.cell, l.slot, l.away});
    for (int axis = 0; axis < 3; ++axis)
      if (l.away[at(axis)] != 0) set_leaving(l.cell, axis);
  }
  const auto before = [](const Mover& a, const Mover& b) {
    return std::tie(a.node, a.slot) < std::tie(b.node, b.slot);
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::is_sorted(movers_.begin(), movers_.end(), before))
      std::sort(movers_.begin(), movers_.end(), before);
    depart(axis, count);
    land(axis, count);
  }
}

// SCAN: a cycle per slot, and the further beats of those that leave. Those who stay close ranks.
void Migration::depart(int axis, std::span<uint32_t> count) {
  for (const uint32_t node : leaving_[at(axis)])  // none, if the last particle left along an earlier axis
    scan_[at(axis)][node].slots = static_cast<int32_t>(count[node]);
  landings_.clear();
  size_t kept = 0;
  uint32_t node = kNoNode, gone = 0;
  for (Mover m : movers_) {
    if (m.node != node) node = m.node, gone = 0;
    const auto direction = static_cast<int>(m.away[at(axis)]);
    if (direction == 0) {
      m.slot -= gone;
      movers_[kept++] = m;
      continue;
    }
    const uint32_t to = lattice_.neighbour(node, 2 * axis + (direction > 0));
    if (to == kNoCell) throw std::invalid_argument("a particle leaves the lattice");
    m.away[at(axis)] = 0;
    ++gone;
    const auto last_beat = static_cast<int32_t>(m.slot + gone * static_cast<uint32_t>(beats_ - 1));
    const auto order = static_cast<uint32_t>(landings_.size());
    departures_[at(axis)].push_back({node, m.slot, 2 * axis + (direction > 0)});
    landings_.push_back({to, direction > 0 ? 0u : 1u, order, m.away, {node, last_beat + on_the_way_, order}});
    --count[node];
    ++scan_[at(axis)][node].left;
  }
  movers_.resize(kept);
}

// TAKE_LOW, TAKE_HIGH: those from below take the next slots, then those from above, each in its sender's
// order.
void Migration::land(int axis, std::span<uint32_t> count) {
  std::sort(landings_.begin(), landings_.end(), [](const Landing& a, const Landing& b) {
    return std::tie(a.to, a.side, a.order) < std::tie(b.to, b.side, b.order);
  });
  for (const Landing& l : landings_) {
    int32_t& group = group_[at(axis)][l.to];
    const auto here = static_cast<uint32_t>(arrivals_.size());
    if (group < 0) {
      group = static_cast<int32_t>(groups_.size());
      groups_.push_back({here, here, here});
      received_[at(axis)].push_back(l.to);
    }
    auto& range = groups_.back();
    if (l.side == 0) range[1] = here + 1;
    range[2] = here + 1;
    arrivals_.push_back(l.arrival);
    const uint32_t slot = count[l.to]++;
    if (l.away == std::array<int8_t, 3>{}) continue;
    movers_.push_back({l.to, slot, l.away});
    for (int later = axis + 1; later < 3; ++later)
      if (l.away[at(later)] != 0) set_leaving(l.to, later);
  }
}

}  // namespace cuboct::emu
