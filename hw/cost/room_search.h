// SPDX-License-Identifier: MIT
// Which brick, lanes and pipes to build where a device has only so much room: the search, for given costs.
// docs/reference/synth.md, "Fitting a device".
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "hw/cost/cycles.h"
#include "hw/plan/plan.h"

namespace cuboct {

struct FitPoint {
  Cell brick{1, 1, 1};
  int lanes = 1, pipes = 1;

  auto operator<=>(const FitPoint&) const = default;
};

// Amounts of a device's resources; which stands where is the caller's affair.
using FitAmounts = std::array<uint64_t, 5>;

// The largest share of the room that is used, and of which resource. What is used of a resource that the
// device does not have is infinitely much.
struct FitShare {
  double share = 0;
  size_t resource = 0;
};
FitShare worst_share(const FitAmounts& used, const FitAmounts& room);
inline bool has_room(const FitAmounts& used, const FitAmounts& room) {
  for (size_t r = 0; r < room.size(); ++r)
    if (used[r] > room[r]) return false;
  return true;
}

inline FitAmounts times(const FitAmounts& amounts, uint64_t n) {
  FitAmounts product;
  for (size_t r = 0; r < amounts.size(); ++r) product[r] = amounts[r] * n;
  return product;
}

// A brick, and how many of them hold all cells of a lattice.
struct FitShape {
  Cell brick{1, 1, 1};
  uint32_t nodes = 0;
};

// All bricks of up to kMostBrickCells cells that the lattice's box has place for, fewer cells first.
std::vector<Cell> possible_bricks(const Lattice& lattice);
// How many bricks hold all cells of the lattice, as hw/arch/bricks.h cuts it.
uint32_t count_bricks(const Lattice& lattice, const Cell& brick);

struct FitSpace {
  std::vector<FitShape> shapes;
  int most_lanes = 1;
  int most_pipes = 1;  // and no more than lanes
};

// What a plan costs. All are pure.
struct FitCosts {
  // Of all its nodes and what stands around them.
  std::function<FitAmounts(const FitShape&, int lanes, int pipes)> uses;
  // A number of cycles per step that it takes at least, quickly told.
  std::function<uint64_t(const FitShape&, int lanes, int pipes)> least_cycles;
  // The cycles; nothing where no such plan can be made.
  std::function<std::optional<uint64_t>(const FitShape&, int lanes, int pipes)> cycles;
};

struct FitChoice {
  FitPoint point;
  uint32_t nodes = 0;
  uint64_t cycles = 0;
  FitAmounts uses{};
};

// The plan with the fewest cycles per step among those that fit; of equals the one that leaves most room (by
// its worst share), then the least by brick, lanes, pipes. Nothing where none fits.
std::optional<FitChoice> fastest_that_fits(const FitSpace& space, const FitAmounts& room,
                                           const FitCosts& costs);

// The plan whose worst share of the room is least, whether it fits or not; of equals the one with fewer
// cycles. Nothing where no plan can be made.
std::optional<FitChoice> nearest_to_fit(const FitSpace& space, const FitAmounts& room, const FitCosts& costs);

// least_cycles of the shapes of one scene: what lanes and pipes of the busiest node have to do, and what
// every node passes beside that. No more than expected_cycles (hw/cost/cycles.h) of the same plan.
class FitLoads {
 public:
  // Refers to all; `plan`: of any brick, lanes and pipes, without narrow memories.
  FitLoads(const Plan& plan, const PairCensus& census);
  // Summed over the rounds.
  uint64_t least_cycles(const Cell& brick, int lanes, int pipes);

 private:
  struct Load {
    std::vector<uint64_t> streamed;  // by lanes - 1: candidates and slots of the node that has most
    uint64_t pairs = 0;              // of the node that has most
  };
  const Load& load(const Cell& brick);

  const Plan& plan_;
  const PairCensus& census_;
  Cell low_;
  std::vector<uint64_t> near_;  // by cell: particles of all cells around it, itself included
  std::map<Cell, Load> loads_;
};

}  // namespace cuboct
