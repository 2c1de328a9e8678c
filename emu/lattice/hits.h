// SPDX-License-Identifier: MIT
// The filter of a node on vector units: how many own particles each candidate meets in each pass.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "emu/lattice/force_time.h"
#include "model/fixed_rule.h"

namespace cuboct::emu {

// `difference` and `may_interact` of model/fixed_rule.h in 32 bits. They suffice for all formats: P <= 30, so
// that candidates lie in [-2^30, 2^31) and differences in (-2^31, 2^31); |d| <= 2^(D+1) with D <= 24, and a sum
// of three is below 2^27.
struct PlanarTest {
  explicit PlanarTest(const FixedRule& rule);
  int position_frac;
  int shift;                        // P - D
  std::array<int32_t, 3> planar{};  // D fractional bits
};

// Particles by node. Vectors may be loaded beyond the last particle: 64 more elements can be read. Node number
// `nodes` stands for one that does not exist: it holds nothing, and its neighbours are itself.
struct Places {
  std::array<const int32_t*, 3> x;
  const uint32_t* first;                      // nodes + 2
  const std::array<uint32_t, 6>* neighbour;  // nodes + 1
};

struct HitScratch {
  std::array<std::vector<int32_t>, 3> x;  // candidates in the frame of the node
  std::vector<uint8_t> hits, service;
};

struct Filter {
  PlanarTest test;
  int lanes;                           // own particles per pass
  std::array<uint8_t, 65> service{};  // ceil(hits / force_pipes), by hits
};

// The work of `node`'s force engine; its services stay valid until `scratch` is used again. `node` is not empty.
ForceWork filter_node(const Filter& filter, const Places& places, uint32_t node, HitScratch& scratch);

}  // namespace cuboct::emu
