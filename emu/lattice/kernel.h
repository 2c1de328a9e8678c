// SPDX-License-Identifier: MIT
// The pair term and the update over a block, for each instruction set.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emu/lattice/block.h"

namespace cuboct::emu {

// Which groups and particles to work on. Null pointers: all.
struct Active {
  const uint8_t* group = nullptr;  // by group: some pair of it may be needed
  const uint8_t* node = nullptr;   // by node: its particles are updated
  bool track = false;              // tell which particles changed
};

struct Kernels {
  std::string name;
  // The entries of `from` with a pair within `reach` (P fractional bits). Its k-th group is `groups[k]` of the block,
  // or k where `groups` is null.
  void (*prune)(const Particles&, double reach, uint32_t first_group, const std::vector<uint32_t>* groups,
                const PairList& from, PairList& to);
  // Sums of the pairs with other blocks.
  void (*across)(const KernelRule&, const Particles&, const Active&, Block&);
  // Pairs inside the block, then each group's update.
  void (*inside)(const KernelRule&, Particles&, const Active&, Block&);
};

// Those that this machine runs and `rule` allows: the widest first; "portable", plain integers that fit every
// rule, last.
std::vector<Kernels> kernels_here(const KernelRule& rule);

// Lanes of a pair (or an update) that something did not fit: plain integers find out what.
void report_pair(const KernelRule& rule, const Particles& particles, uint32_t i, uint32_t j, uint8_t shift,
                 bool both, Block& block);
void update_one(const KernelRule& rule, Particles& particles, uint32_t p, const double sum[3], Block& block);

}  // namespace cuboct::emu
