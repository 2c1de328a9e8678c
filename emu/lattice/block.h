// SPDX-License-Identifier: MIT
// What one thread works on: a range of groups of particles and the pairs among and around them.
//
// Particles are stored in a row, kGroup to a group. In a crystal whose rows are stored one after the other,
// the partners of a group's particles are themselves kGroup particles in a row, so a pair list needs one
// entry for kGroup pairs, and their positions one vector load each: no gather. In a fluid an entry has few
// pairs. Any set of pairs can be written so.
//
// Inside a block each pair stands once, at its particle of lower index: the kick of the other one is added to
// a ring of sums that runs ahead of the groups. When a group's own entries are done, nobody else needs its
// old positions, and its sums are complete: it is updated on the spot. Pairs between blocks stand on both
// sides and are summed before any block is updated.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/aligned.h"
#include "emu/lattice/entry.h"
#include "emu/lattice/kernel_rule.h"
#include "emu/timing/slots.h"
#include "model/base/error.h"

namespace cuboct::emu {

// Structure of arrays over all particles of this process, its ghosts behind them.
struct Particles {
  std::array<PaddedArray<double>, 3> x;  // visible: P fractional bits, from the corner of cell (0, 0, 0);
                                         // unwrapped since the last list was built
  std::array<PaddedArray<int32_t>, 3> residue;  // the G bits of a position below those, in [0, 2^G); not of
                                                // ghosts
  std::array<PaddedArray<double>, 3> v;         // P+G fractional bits
  std::array<PaddedArray<double>, 3> u;         // P+G fractional bits; empty unless the rule has PD
  std::vector<PaddedArray<double>> fields;      // by number: what a program keeps of a particle besides
  PaddedArray<uint32_t> id;  // empty where a particle's index is its id; else kNoParticle where a block's
                             // last group is not full
  uint32_t id_of(uint32_t index) const { return id.size() == 0 ? index : id[index]; }
  const uint32_t* cell = nullptr;  // readable kGroup elements beyond
  PaddedArray<uint8_t> type;
  // By group: its cells are among low ... low + span - 1. Wider than need be after migrations.
  struct Cells {
    uint32_t low, span;
  };
  std::vector<Cells> group_cells;
  // What to add to x_j - x_i where the pair meets across the seam of a periodic box: (sx+1) + 3 (sy+1) + 9
  // (sz+1) periods.
  std::array<std::array<double, 3>, 27> shift{};
};
inline constexpr uint32_t kNoParticle = 0xffffffffu;

// P+G fractional bits, from the corner of cell (0, 0, 0).
inline Int3 exact_position(const Particles& particles, uint32_t p, int guard) {
  Int3 x;
  for (size_t a = 0; a < 3; ++a)
    x[a] = (static_cast<int64_t>(particles.x[a][p]) << guard) + particles.residue[a][p];
  return x;
}

// Something that did not fit; the cell is found from the particle.
struct Found {
  Fault fault;
  uint32_t particle;  // index
  int64_t number;
};

// Entries by group.
struct PairList {
  using Group = EntryGroup;
  std::vector<Group> groups;
  std::vector<Entry, Untouched<Entry>> entries;
};

// One-sided pairs, for the groups that have any.
struct Edge {
  std::vector<uint32_t> group;  // ascending, less first_group()
  PairList pairs;               // one of its groups each
  PaddedArray<double> sum;      // 3 x kGroup each
};

struct Block {
  uint32_t begin = 0, end = 0;  // particles (indices), begin a multiple of kGroup
  uint32_t first_group() const { return begin / kGroup; }
  uint32_t groups() const { return groups_of(end - begin); }

  PairList inside;             // pairs inside the block
  Edge beside;                 // pairs with other blocks
  Edge ghosts;                 // pairs with particles of other ranks
  std::vector<uint8_t> plain;  // by group: updated in vectors

  // Sums of particle p at index p - begin modulo the ring's size, a power of two, kMagic where nothing was
  // added; a vector may overhang the end, where the next lap's first kGroup sums continue.
  std::array<PaddedArray<double>, 3> ring;
  uint32_t ring_mask = 0;
  uint32_t window = 0;  // particles that entries of `inside` lead ahead, at most

  // Answers of a step.
  std::vector<Crossing> crossings;  // indices
  std::vector<Found> pair_faults, update_faults;
  double fastest2 = 0;  // largest v.v
};

// The sums of an edge while its block's groups go by.
class EdgeSums {
 public:
  explicit EdgeSums(const Edge& edge) : edge_(edge) {}
  // Of the block's k-th group, k ascending: 3 x kGroup sums, or null.
  const double* next(uint32_t k) {
    if (at_ == edge_.group.size() || edge_.group[at_] != k) return nullptr;
    return &edge_.sum[at_++ * 3 * kGroup];
  }

 private:
  const Edge& edge_;
  size_t at_ = 0;
};

}  // namespace cuboct::emu
