// SPDX-License-Identifier: MIT
// Small plans that between them use every feature of a node, for the tests that compare engines.
#pragma once

#include <string>
#include <vector>

#include "hw/plan/setup.h"

namespace cuboct::test {

struct Case {
  std::string name;
  Setup setup;
  uint64_t steps = 0;
  Scene scene{};  // of which the setup was made
};

// One feature or awkward size each.
std::vector<std::string> case_names();
// `name` with ".detect" or ".retry": the same with checked links; with ".snug": in the fewest nodes, for a
// few steps. Behind either, ".brick_2x1x2": on nodes that serve such bricks of cells.
Case make_case(const std::string& name);

// Features, sizes and initial state drawn from `seed`.
Case random_case(uint64_t seed);
// A periodic box that no cube divides, of 5 x 4 x 6 crystal cells in any order.
Case uneven_case(uint64_t seed);
// The same without a third axis.
Case random_flat_case(uint64_t seed);

// The same on nodes that serve bricks of cells.
Case with_brick(Case c, const Cell& brick);
// The same on nodes that use halos on arrival, with two streamers where there are as many lanes.
Case with_halos_on_arrival(Case c);
// The same on several devices, without checks of links.
Case with_boards(Case c, const DeviceCut& boards);
// Two hot blocks, the second beyond the first by these many cells (signed) along each axis, on a lattice of
// only those cells that ever hold a particle: what lies between them has none.
Case lumps(const Vec3& apart);
// Bricks that this lattice can be cut into: thin ones, cubes, ones that leave a rest, the whole of it.
std::vector<Cell> bricks_for(const Lattice& lattice);
// A random case, of three axes or two, with a random brick.
Case random_brick_case(uint64_t seed);

// A case of this fault, which golden must meet within `steps`. Those that need narrow formats share one rule
// and arch.
Case fault_case(Fault fault);
std::vector<Fault> all_faults();
// The case with narrow memories.
Case with_narrow_memories(Case c);

}  // namespace cuboct::test
