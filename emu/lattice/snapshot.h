// SPDX-License-Identifier: MIT
// Where the far list found the particles, and in which bins it looks for them.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/block.h"
#include "emu/lattice/members.h"
#include "model/contract/lattice.h"

namespace cuboct::emu {

// Fractional bits of a cell edge in which pairs are searched and displacements are measured. Coarse
// coordinates are taken modulo 2^32: only differences over a few cells are used.
inline constexpr int kCoarse = 16;
inline int32_t coarse(double x, int position_frac) {
  const auto whole = static_cast<int64_t>(x);
  return static_cast<int32_t>(position_frac >= kCoarse ? whole >> (position_frac - kCoarse)
                                                       : whole << (kCoarse - position_frac));
}

// By index.
struct Snapshot {
  std::array<PaddedArray<int32_t>, 3> at;
  int position_frac = 0;
  int threads = 1;
  uint32_t room = 0;  // particles stored here, with those of other ranks

  // The distance of a particle from its place here, in cells, rounded up; the largest of [begin, end).
  double moved(const Particles& particles, uint32_t particle) const;
  double displacement(const Particles& particles, uint32_t begin, uint32_t end) const;
  // Whether a particle is farther than `threshold` cells from its place here, or that place is not in the
  // particle's cell.
  bool astray(const Lattice& lattice, const Particles& particles, uint32_t particle, double threshold) const;
  void look(const Particles& particles, uint32_t particle);

 private:
  double moved2(const Particles& particles, uint32_t particle) const;  // coarse units
};

// Where the particle of an id is stored.
struct Index {
  std::vector<uint32_t> by_id;  // kNoParticle: elsewhere; empty: at its id
  uint32_t operator()(uint32_t id) const { return by_id.empty() ? id : by_id[id]; }
};

// The particles stored here sorted by cell and slot: those of a stretch of cells are a stretch of arrays.
struct Bins {
  Bins(const Lattice& lattice, const Members& members, const Index& index, const Particles& particles,
       int position_frac, int threads);
  std::vector<uint32_t> first;  // cells + 1
  std::array<PaddedArray<int32_t>, 3> at;
  PaddedArray<uint32_t> particle;

  // Leaves the places to `snapshot`, by index, and nothing here.
  void release_to(Snapshot& snapshot);
};

}  // namespace cuboct::emu
