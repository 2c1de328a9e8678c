// SPDX-License-Identifier: MIT
#include "emu/lattice/snapshot.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "model/base/parallel.h"

namespace cuboct::emu {

void Snapshot::look(const Particles& particles, uint32_t particle) {
  for (int a = 0; a < 3; ++a) at[a][particle] = coarse(particles.x[a][particle], position_frac);
}

double Snapshot::moved2(const Particles& particles, uint32_t particle) const {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    // Modulo 2^32: a particle may have passed the seam of a ring since.
    const auto d = static_cast<double>(
        static_cast<int32_t>(static_cast<uint32_t>(coarse(particles.x[a][particle], position_frac)) -
                             static_cast<uint32_t>(at[a][particle])));
    sum += d * d;
  }
  return sum;
}

// Each coordinate is rounded down to a coarse unit, then and now: a difference is wrong by less than one.
double Snapshot::moved(const Particles& particles, uint32_t particle) const {
  return std::ldexp(std::sqrt(moved2(particles, particle)) + 2, -kCoarse);
}

double Snapshot::displacement(const Particles& particles, uint32_t begin, uint32_t end) const {
  double most = 0;
  std::mutex joining;
  const auto look = [&](size_t first, size_t last) {
    double most_here = 0;
    for (size_t p = begin + first; p < begin + last; ++p)
      most_here = std::max(most_here, moved2(particles, static_cast<uint32_t>(p)));
    const std::lock_guard lock(joining);
    most = std::max(most, most_here);
  };
  for_each_range(end - begin, 1, look, threads);
  return std::ldexp(std::sqrt(most) + 2, -kCoarse);
}

bool Snapshot::astray(const Lattice& lattice, const Particles& particles, uint32_t particle,
                      double threshold) const {
  static_assert(kCoarse == 16);  // a place keeps 16 bits of its cell
  const Cell& cell = lattice.cell(particles.cell[particle]);
  for (int a = 0; a < 3; ++a)
    if (at[a][particle] >> kCoarse != static_cast<int16_t>(cell[a])) return true;
  return moved(particles, particle) > threshold;
}

Bins::Bins(const Lattice& lattice, const Members& members, const Index& index, const Particles& particles,
           int position_frac, int threads)
    : first(lattice.size() + 1) {
  const auto for_each_here = [&](uint32_t cell, const auto& see) {
    members.for_each(cell, [&](uint32_t id) {
      if (const uint32_t p = index(id); p != kNoParticle) see(p);
    });
  };
  uint32_t count = 0;
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    first[n] = count;
    if (index.by_id.empty())
      count += static_cast<uint32_t>(members.count(n));
    else
      for_each_here(n, [&](uint32_t) { ++count; });
  }
  first[lattice.size()] = count;
  for (auto& array : at) array = PaddedArray<int32_t>(count);
  particle = PaddedArray<uint32_t>(count);
  const auto take = [&](size_t begin, size_t end) {
    for (auto n = static_cast<uint32_t>(begin); n < end; ++n) {
      uint32_t k = first[n];
      for_each_here(n, [&](uint32_t p) {
        for (int a = 0; a < 3; ++a) at[a][k] = coarse(particles.x[a][p], position_frac);
        particle[k++] = p;
      });
    }
  };
  for_each_range(lattice.size(), 1, take, threads);
}

void Bins::release_to(Snapshot& snapshot) {
  for (int a = 0; a < 3; ++a) {
    const size_t room = snapshot.room;
    if (snapshot.at[a].size() != room) snapshot.at[a] = PaddedArray<int32_t>(room);
    for (uint32_t k = 0; k < particle.size(); ++k) snapshot.at[a][particle[k]] = at[a][k];
    at[a] = {};
  }
  particle = {};
}

}  // namespace cuboct::emu
