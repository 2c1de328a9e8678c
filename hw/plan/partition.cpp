// SPDX-License-Identifier: MIT
#include "hw/plan/partition.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <map>
#include <set>

#include "hw/arch/cell_box.h"
#include "model/base/error.h"
#include "model/base/integer_math.h"

namespace cuboct {
namespace {

// The lengths that cut `nodes` into 1, 2, 3, ... parts, none longer than needed.
std::vector<int32_t> lengths_of(int32_t nodes) {
  std::set<int32_t> lengths;
  for (int32_t parts = 1; parts <= nodes; ++parts) lengths.insert(ceil_div(nodes, parts));
  return {lengths.begin(), lengths.end()};
}

uint64_t volume(const Cell& c) {
  return uint64_t{static_cast<uint32_t>(c[0])} * static_cast<uint32_t>(c[1]) * static_cast<uint32_t>(c[2]);
}

// Of all faces at this interval, both ways. A face's lanes are whole ones.
uint64_t lanes_at(const Partition& p, int beat_bits, double bits_per_cycle, int interval) {
  uint64_t lanes = 0;
  for (size_t a = 0; a < 3; ++a) {
    const double bits = static_cast<double>(p.links[a]) * beat_bits;
    // Out and in.
    lanes += 2 * static_cast<uint64_t>(p.faces[a]) *
             static_cast<uint64_t>(std::ceil(bits / (bits_per_cycle * interval)));
  }
  return lanes;
}

// A rough count of the cycles that the links cost a step, to choose by: along each axis that is cut a wait
// for each round that sends and one for migration, and the beats of the rounds, of 1, 3 and 9 cells' records.
double cost_of(const Partition& p, const Plan& plan, double particles_per_node) {
  int sending = 0;
  double cost = 0, beats = 0;
  for (const PlanRound& round : plan.rounds)
    sending += round.beats > 0, beats += particles_per_node * round.beats;
  for (size_t a = 0; a < 3; ++a, beats *= 3)
    if (p.links[a] > 0)
      cost += (sending + 1) * p.boards.latency + (p.boards.interval - 1) * (beats + sending);
  return cost;
}

}  // namespace

int board_beat_bits(const Plan& plan) { return plan.words.link_bits + 2; }

Cell node_grid(const Plan& plan) {
  const CellBox box = box_of(plan.lattice, true);
  Cell grid;
  for (size_t a = 0; a < 3; ++a)
    grid[a] = ceil_div(static_cast<int32_t>(box.extent(a)), plan.bricks.shape()[a]);
  return grid;
}

Partition partition_of(const Plan& plan, const DeviceLinkKind& kind, double clock, const Cell& nodes) {
  const Cell grid = node_grid(plan);
  Partition p;
  p.boards.nodes = nodes;
  for (size_t a = 0; a < 3; ++a) p.devices[a] = ceil_div(grid[a], nodes[a]);
  for (size_t a = 0; a < 3; ++a) {
    if (p.devices[a] == 1) continue;
    p.links[a] = static_cast<int32_t>(volume(nodes) / static_cast<uint64_t>(nodes[a]));
    p.faces[a] = p.devices[a] == 2 && plan.lattice.period()[a] == 0 ? 1 : 2;
  }
  const double bits = kind.bits_per_cycle(clock);
  const auto lanes = [&](int interval) { return lanes_at(p, board_beat_bits(plan), bits, interval); };
  int low = 1, high = DeviceCut::kMostInterval;  // lanes fall as the interval grows
  while (low < high) {
    const int middle = (low + high) / 2;
    if (lanes(middle) <= kind.lanes())
      high = middle;
    else
      low = middle + 1;
  }
  p.boards.interval = low;
  p.lanes = lanes(low);
  p.boards.latency = kind.latency(clock, low);
  if (p.boards.latency > DeviceCut::kMostLatency)
    throw InputError(fmt::format("{}: a latency of {} cycles is more than {}", kind.name, p.boards.latency,
                                 DeviceCut::kMostLatency),
                     "a slower clock, or a link with less delay");
  return p;
}

std::vector<Partition> partitions(const Plan& plan, const DeviceLinkKind& kind, double clock, uint64_t room,
                                  double particles_per_node) {
  const Cell grid = node_grid(plan);
  std::map<int, Partition> best;  // by the power of two of devices
  const auto better = [&](const Partition& a, const Partition& b) {
    if (enough_lanes(a, kind) != enough_lanes(b, kind)) return enough_lanes(a, kind);
    if (!enough_lanes(a, kind) && a.lanes != b.lanes) return a.lanes < b.lanes;
    const double x = cost_of(a, plan, particles_per_node), y = cost_of(b, plan, particles_per_node);
    return x != y ? x < y : a.count() != b.count() ? a.count() < b.count() : a.boards.nodes < b.boards.nodes;
  };
  for (const int32_t x : lengths_of(grid[0]))
    for (const int32_t y : lengths_of(grid[1]))
      for (const int32_t z : lengths_of(grid[2])) {
        if (volume({x, y, z}) > room) continue;
        const Partition p = partition_of(plan, kind, clock, {x, y, z});
        const int power = std::bit_width(p.count() - 1);
        const auto [found, is_new] = best.try_emplace(power, p);
        if (!is_new && better(p, found->second)) found->second = p;
      }
  std::vector<Partition> out;
  for (const auto& [power, p] : best) out.push_back(p);
  return out;
}

}  // namespace cuboct
