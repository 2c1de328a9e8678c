// SPDX-License-Identifier: MIT
// The pair term and the update over a block, for each instruction set.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "emu/lattice/block.h"

namespace cuboct::emu {

// Which particles to work on.
struct Active {
  // Flags by cell, readable 8 bytes beyond; null: all are awake.
  const uint8_t* near = nullptr;   // pairs of its particles may be needed
  const uint8_t* awake = nullptr;  // its particles are updated
  uint8_t* changed = nullptr;      // by cell: set to 1 where a particle changed; null: nobody asks
  Int3* sums = nullptr;            // by index: `inside` leaves the pairs' sums here and updates nothing

  // Particles of one cell may be in the blocks of several threads.
  void mark(uint32_t cell) const {
    std::atomic_ref<uint8_t>(changed[cell]).store(1, std::memory_order_relaxed);
  }
};

// Whether one of the cells of group g has a flag; may say yes too often.
inline bool any_flag(const uint8_t* cell_flag, const Particles& particles, uint32_t g) {
  const auto [low, span] = particles.group_cells[g];
  for (uint32_t n = 0; n < span; n += 8) {
    uint64_t eight;  // arrays of flags are readable 8 bytes beyond their ends
    std::memcpy(&eight, cell_flag + low + n, 8);
    if (span - n < 8) eight &= (uint64_t{1} << 8 * (span - n)) - 1;
    if (eight != 0) return true;
  }
  return false;
}

struct Kernels {
  std::string name;
  // Puts the entries with a pair within `reach` (P fractional bits) first in their groups, in the groups with
  // a particle in a cell of `only` (by cell; null: all).
  void (*prune)(const Particles&, double reach, const uint8_t* only, Block&);
  // The sums of an edge of the block.
  void (*across)(const KernelRule&, const Particles&, const Active&, Edge&, Block&);
  // Pairs inside the block, then each group's update.
  void (*inside)(const KernelRule&, Particles&, const Active&, Block&);
  // Each group's update alone, by the sums that `inside` has left.
  void (*update)(const KernelRule&, Particles&, const Active&, const Int3* sums, Block&);
};

// Those that this machine runs and `rule` allows: the widest first; "portable", plain integers that fit every
// rule, last.
std::vector<Kernels> kernels_here(const KernelRule& rule);

// Lanes of a pair (or an update) that something did not fit: plain integers find out what.
void report_pair(const KernelRule& rule, const Particles& particles, uint32_t i, uint32_t j, uint8_t shift,
                 bool both, Block& block);
void update_one(const KernelRule& rule, Particles& particles, uint32_t p, const Int3& sum,
                const Active& active, Block& block);

}  // namespace cuboct::emu
