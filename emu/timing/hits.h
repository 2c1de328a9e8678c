// SPDX-License-Identifier: MIT
// The filter of a node on vector units: how many own particles each candidate meets in each pass.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/timing/force_time.h"
#include "model/contract/fixed_rule.h"
#include "model/graph/bond_rows.h"

namespace cuboct::emu {

// `may_interact` of model/contract/fixed_rule.h in 32 bits. They suffice for all formats: P <= 30, so that
// candidates lie in [-2^30, 2^31); sizes are below 2^(B+1) with B <= 16.
struct PlanarBounds {
  explicit PlanarBounds(const FixedRule& rule);
  int position_frac;                // P
  int shift;                        // P - B
  size_t layers;                    // of cells around a node's along z: 3, or 1 in a flat plan
  std::array<int32_t, 3> planar{};  // B fractional bits
};

struct Filter {
  Filter(const FixedRule& rule, int lanes, int pipes);
  PlanarBounds test;
  uint32_t lanes, pipes;
};

struct NodeSlot {
  uint32_t node = 0, slot = 0;
};

// Particles by node. Node number `nodes` stands for one that does not exist: it holds nothing, and its
// neighbours are itself.
struct Places {
  // Elements that vector loads may read beyond the last particle.
  static constexpr size_t kBeyond = 64;
  std::array<const int32_t*, 3> x;
  const uint32_t* first;                     // nodes + 2
  const std::array<uint32_t, 6>* neighbour;  // nodes + 1
  // Of a bonded rule, in place of x; else null.
  const graph::BondRows* rows = nullptr;
  const uint32_t* id = nullptr;     // of each particle
  const NodeSlot* where = nullptr;  // by id
};

struct HitScratch {
  HitScratch(int capacity, int lanes);
  std::array<std::vector<int32_t>, 3> x;  // candidates in the frame of the node, B fractional bits
  size_t row;                             // candidates, and room for a vector
  std::vector<uint8_t> hits;              // [pass][candidate], rows of `row`
  std::vector<uint8_t> items;             // hits by item
  std::vector<uint32_t> entries;          // of the ForceWork that filter_node returned last
  std::vector<int64_t> popped;            // scratch of force_time
};

// What the streamer of `node`, which is not empty, walks.
ForceWork filter_node(const Filter& filter, const Places& places, uint32_t node, HitScratch& scratch);
// The same of a bonded rule: a candidate meets the own particles that have a bond to it.
ForceWork filter_bonds(const Filter& filter, const Places& places, uint32_t node, HitScratch& scratch);

}  // namespace cuboct::emu
