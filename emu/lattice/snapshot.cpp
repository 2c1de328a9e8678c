// SPDX-License-Identifier: MIT
#include "emu/lattice/snapshot.h"

#include <algorithm>
#include <cmath>

namespace cuboct::emu {

void Snapshot::look(const Particles& particles, uint32_t place) {
  const uint32_t p = particle[place];
  x[place] = coarse(particles.x[0][p], position_frac);
  y[place] = coarse(particles.x[1][p], position_frac);
  z[place] = coarse(particles.x[2][p], position_frac);
}

void Snapshot::take(const Lattice& lattice, const Members& members, Particles& particles) {
  const uint32_t nodes = lattice.size();
  first.resize(nodes + 1);
  uint32_t at = 0;
  for (uint32_t n = 0; n < nodes; ++n) {
    first[n] = at;
    at += static_cast<uint32_t>(members.count(n));
  }
  first[nodes] = at;
  if (particle.size() != at) {
    for (auto* array : {&x, &y, &z}) *array = PaddedArray<int32_t>(at);
    particle = PaddedArray<uint32_t>(at);
  }
  const double cell = std::ldexp(1.0, position_frac), inverse = std::ldexp(1.0, -position_frac);
#pragma omp parallel for num_threads(threads)
  for (uint32_t n = 0; n < nodes; ++n) {
    uint32_t k = first[n];
    members.for_each(n, [&](uint32_t p) {
      for (int a = 0; a < 3; ++a) {
        double& at_a = particles.x[a][p];
        at_a += (lattice.cell(n)[a] - std::floor(at_a * inverse)) * cell;
      }
      particle[k] = p;
      look(particles, k++);
    });
  }
}

double Snapshot::moved2(const Particles& particles, uint32_t place) const {
  const uint32_t p = particle[place];
  // Modulo 2^32: a particle may have passed the seam of a ring since.
  const auto d = [&](int32_t was, int a) {
    return static_cast<double>(static_cast<int32_t>(
        static_cast<uint32_t>(coarse(particles.x[a][p], position_frac)) - static_cast<uint32_t>(was)));
  };
  const double dx = d(x[place], 0), dy = d(y[place], 1), dz = d(z[place], 2);
  return dx * dx + dy * dy + dz * dz;
}

// Each coordinate is rounded down to a coarse unit, then and now: a difference is wrong by less than one.
double Snapshot::displacement(const Particles& particles) const {
  double most = 0;
#pragma omp parallel for reduction(max : most) num_threads(threads)
  for (uint32_t k = 0; k < particle.size(); ++k) most = std::max(most, moved2(particles, k));
  return std::ldexp(std::sqrt(most) + 2, -kCoarse);
}

std::vector<uint32_t> Snapshot::places() const {
  std::vector<uint32_t> place(particle.size());
#pragma omp parallel for num_threads(threads)
  for (uint32_t k = 0; k < particle.size(); ++k) place[particle[k]] = k;
  return place;
}

std::vector<uint32_t> Snapshot::retake(const Lattice& lattice, const Members& members,
                                       const Particles& particles, double threshold, size_t most) {
  const double inverse = std::ldexp(1.0, -position_frac);
  const double far2 = std::pow(std::max(0.0, std::ldexp(threshold, kCoarse) - 2), 2);
  std::vector<uint8_t> moved(particle.size());  // by particle
  size_t count = 0;
  bool passed = false;
#pragma omp parallel for num_threads(threads) reduction(+ : count) reduction(|| : passed)
  for (uint32_t n = 0; n < lattice.size(); ++n)
    for (uint32_t k = first[n]; k < first[n + 1]; ++k) {
      const uint32_t p = particle[k], node = particles.node[p];
      if (node == n && moved2(particles, k) <= far2) continue;
      moved[p] = 1;
      ++count;
      for (int a = 0; a < 3; ++a)
        passed = passed || std::floor(particles.x[a][p] * inverse) != lattice.cell(node)[a];
    }
  if (count > most || passed) return {};
  const std::vector<uint32_t> place = places();
  const Snapshot old = std::move(*this);
  first.resize(lattice.size() + 1);
  for (auto* array : {&x, &y, &z}) *array = PaddedArray<int32_t>(old.particle.size());
  particle = PaddedArray<uint32_t>(old.particle.size());
  position_frac = old.position_frac;
  threads = old.threads;
  std::vector<uint32_t> renewed;
  uint32_t at = 0;
  for (uint32_t n = 0; n < lattice.size(); ++n) {
    first[n] = at;
    members.for_each(n, [&](uint32_t p) {
      particle[at] = p;
      if (moved[p] != 0) {
        look(particles, at);
        renewed.push_back(at);
      } else {
        const uint32_t was = place[p];
        x[at] = old.x[was];
        y[at] = old.y[was];
        z[at] = old.z[was];
      }
      ++at;
    });
  }
  first[lattice.size()] = at;
  return renewed;
}

}  // namespace cuboct::emu
