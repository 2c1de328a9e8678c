// SPDX-License-Identifier: MIT
#include "hw/cost/room_search.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "hw/arch/cell_box.h"
#include "model/base/integer_math.h"

namespace cuboct {
namespace {

// The brick that a cell belongs to, as one number.
uint64_t brick_of(const Cell& cell, const Cell& low, const Cell& brick) {
  uint64_t key = 0;
  for (int a = 2; a >= 0; --a)
    key = key << 21 | static_cast<uint64_t>((cell[as_size(a)] - low[as_size(a)]) / brick[as_size(a)]);
  return key;
}

struct Candidate {
  size_t shape = 0;
  int lanes = 0, pipes = 0;
  uint64_t least = 0;
  FitAmounts uses{};
  double share = 0;
};

FitPoint point_of(const FitSpace& space, const Candidate& c) {
  return {space.shapes[c.shape].brick, c.lanes, c.pipes};
}

}  // namespace

FitShare worst_share(const FitAmounts& used, const FitAmounts& room) {
  FitShare worst;
  for (size_t r = 0; r < used.size(); ++r) {
    const double share = used[r] == 0   ? 0
                         : room[r] == 0 ? std::numeric_limits<double>::infinity()
                                        : static_cast<double>(used[r]) / static_cast<double>(room[r]);
    if (share > worst.share) worst = {share, r};
  }
  return worst;
}

std::vector<Cell> possible_bricks(const Lattice& lattice) {
  std::vector<Cell> bricks;
  const CellBox box = box_of(lattice, true);
  for (int32_t z = 1; z <= box.extent(2) && z <= kMostBrickCells; ++z)
    for (int32_t y = 1; y <= box.extent(1) && y * z <= kMostBrickCells; ++y)
      for (int32_t x = 1; x <= box.extent(0) && x * y * z <= kMostBrickCells; ++x)
        bricks.push_back({x, y, z});
  std::ranges::stable_sort(bricks, {}, cells_of);
  return bricks;
}

uint32_t count_bricks(const Lattice& lattice, const Cell& brick) {
  if (cells_of(brick) == 1) return lattice.size();
  const Cell low = box_of(lattice, true).low;
  std::vector<uint64_t> keys;
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    const uint64_t key = brick_of(lattice.cell(n), low, brick);
    if (keys.empty() || keys.back() != key) keys.push_back(key);  // cells come row by row
  }
  std::ranges::sort(keys);
  return static_cast<uint32_t>(std::unique(keys.begin(), keys.end()) - keys.begin());
}

namespace {

template <typename See>
void for_each_candidate(const FitSpace& space, const FitAmounts& room, const FitCosts& costs,
                        const See& see) {
  for (size_t s = 0; s < space.shapes.size(); ++s)
    for (int lanes = 1; lanes <= space.most_lanes; ++lanes)
      for (int pipes = 1; pipes <= std::min(lanes, space.most_pipes); ++pipes) {
        const FitAmounts uses = costs.uses(space.shapes[s], lanes, pipes);
        see(Candidate{s, lanes, pipes, 0, uses, worst_share(uses, room).share});
      }
}

}  // namespace

std::optional<FitChoice> fastest_that_fits(const FitSpace& space, const FitAmounts& room,
                                           const FitCosts& costs) {
  std::vector<Candidate> fitting;
  for_each_candidate(space, room, costs, [&](Candidate c) {
    if (!has_room(c.uses, room)) return;
    c.least = costs.least_cycles(space.shapes[c.shape], c.lanes, c.pipes);
    fitting.push_back(c);
  });
  std::ranges::stable_sort(fitting, {}, &Candidate::least);
  std::optional<Candidate> best;
  uint64_t best_cycles = 0;
  for (const Candidate& c : fitting) {
    if (best && c.least > best_cycles) break;
    const auto cycles = costs.cycles(space.shapes[c.shape], c.lanes, c.pipes);
    if (!cycles) continue;
    if (!best || std::tuple{*cycles, c.share, point_of(space, c)} <
                     std::tuple{best_cycles, best->share, point_of(space, *best)}) {
      best = c;
      best_cycles = *cycles;
    }
  }
  if (!best) return std::nullopt;
  return FitChoice{point_of(space, *best), space.shapes[best->shape].nodes, best_cycles, best->uses};
}

std::optional<FitChoice> nearest_to_fit(const FitSpace& space, const FitAmounts& room,
                                        const FitCosts& costs) {
  std::vector<Candidate> all;
  for_each_candidate(space, room, costs, [&](const Candidate& c) { all.push_back(c); });
  std::ranges::stable_sort(all, {}, &Candidate::share);
  std::optional<FitChoice> best;
  double share = 0;
  for (const Candidate& c : all) {
    if (best && c.share > share) break;
    const auto cycles = costs.cycles(space.shapes[c.shape], c.lanes, c.pipes);
    if (!cycles || (best && std::tuple{*cycles, point_of(space, c)} >= std::tuple{best->cycles, best->point}))
      continue;
    best = {point_of(space, c), space.shapes[c.shape].nodes, *cycles, c.uses};
    share = c.share;
  }
  return best;
}

FitLoads::FitLoads(const Plan& plan, const PairCensus& census)
    : plan_(plan), census_(census), low_(box_of(plan.lattice, true).low), near_(plan.lattice.size()) {
  for (uint32_t n = 0; n < plan.lattice.size(); ++n)
    for (const auto& [other, offset] : plan.lattice.neighbourhood(n)) near_[n] += census.particles(other);
}

const FitLoads::Load& FitLoads::load(const Cell& brick) {
  const auto [found, is_new] = loads_.try_emplace(brick);
  Load& load = found->second;
  if (!is_new) return load;
  const Lattice& lattice = plan_.lattice;
  std::vector<std::pair<uint64_t, uint32_t>> cells;  // by brick
  for (uint32_t n = 0; n < lattice.size(); ++n)
    if (census_.particles(n) > 0) cells.emplace_back(brick_of(lattice.cell(n), low_, brick), n);
  std::ranges::sort(cells);
  const size_t lanes = as_size(plan_.arch.capacity);  // more do not shorten a pass
  load.streamed.assign(lanes, 0);
  for (size_t first = 0; first < cells.size();) {
    size_t last = first;
    uint64_t pairs = 0, slots = 0;
    std::vector<uint64_t> candidates(lanes, 0);
    for (; last < cells.size() && cells[last].first == cells[first].first; ++last) {
      const uint32_t n = cells[last].second;
      const uint64_t own = census_.particles(n);
      pairs += census_.pairs(n);
      slots += own;
      for (size_t l = 0; l < lanes; ++l) candidates[l] += (own + l) / (l + 1) * near_[n];
    }
    load.pairs = std::max(load.pairs, pairs);
    for (size_t l = 0; l < lanes; ++l)
      load.streamed[l] = std::max(load.streamed[l], candidates[l] + slots - 1);
    first = last;
  }
  return load;
}

uint64_t FitLoads::least_cycles(const Cell& brick, int lanes, int pipes) {
  const Load& of = load(brick);
  const Latency& latency = plan_.latency;
  const uint64_t streamed = of.streamed[std::min(as_size(lanes), of.streamed.size()) - 1];
  const uint64_t issues = (of.pairs + as_size(pipes) - 1) / as_size(pipes) * as_size(latency.interval);
  // The ends of force, update and of each migrate phase: filter, pipe, the last slot's way, an end beat.
  uint64_t cycles = as_size(plan_.rule.axes) * (3 + as_size(plan_.link.latency));
  for (const PlanRound& round : plan_.rounds)
    cycles += std::max(streamed + as_size(latency.filter), issues) + 2 + as_size(round.pipe) +
              as_size(round.finish);
  return cycles;
}

}  // namespace cuboct
