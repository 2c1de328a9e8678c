// SPDX-License-Identifier: MIT
// Where the far list found the particles.
#pragma once

#include <cstdint>
#include <vector>

#include "emu/lattice/block.h"
#include "emu/lattice/members.h"
#include "model/lattice.h"

namespace cuboct::emu {

// Fractional bits of a cell edge in which pairs are searched and displacements are measured.
inline constexpr int kCoarse = 16;
inline int32_t coarse(double x, int position_frac) {
  const auto whole = static_cast<int64_t>(x);
  return static_cast<int32_t>(position_frac >= kCoarse ? whole >> (position_frac - kCoarse)
                                                       : whole << (kCoarse - position_frac));
}

// By node and slot; coarse coordinates modulo 2^32: only differences over a few cells are used.
struct Snapshot {
  std::vector<uint32_t> first;  // nodes + 1
  PaddedArray<int32_t> x, y, z;
  PaddedArray<uint32_t> particle;
  int position_frac = 0;
  int threads = 1;

  // As things stand; positions of particles go back into the cells of the rings.
  void take(const Lattice& lattice, const Members& members, Particles& particles);
  // The same for those that moved farther than `threshold` cells or to another node; the others stay where they
  // were found. Returns them (ascending places in the new snapshot), or nothing where there are more than `most`,
  // or one passed the seam of a ring: then nothing has changed.
  std::vector<uint32_t> retake(const Lattice& lattice, const Members& members, const Particles& particles,
                               double threshold, size_t most);
  // The largest distance of a particle from its place here, in cells, rounded up.
  double displacement(const Particles& particles) const;
  // By particle: its place here.
  std::vector<uint32_t> places() const;

 private:
  double moved2(const Particles& particles, uint32_t place) const;  // coarse units
  void look(const Particles& particles, uint32_t place);
};

}  // namespace cuboct::emu
