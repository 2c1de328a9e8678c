// SPDX-License-Identifier: MIT
// The radial distribution function g(r): how many particles stand at a distance from a particle, over how
// many would in matter of the same density without order. M. P. Allen, D. J. Tildesley, Computer Simulation
// of Liquids (2nd ed., 2017), section 8.2.
#pragma once

#include <cstdint>
#include <vector>

#include "model/contract/rule.h"

namespace cuboct {

struct Rdf {
  double width = 0;             // m, of a bin
  std::vector<uint64_t> pairs;  // by bin: of a particle of A and one of B, over all frames
  std::vector<double> g;        // by bin, 1
  std::vector<double> within;   // by bin: particles of B about one of A, nearer than the bin's end

  double middle(size_t bin) const { return (static_cast<double>(bin) + 0.5) * width; }  // m
};

// Whose pairs count: of a particle of A and one of B. Both empty: of all.
struct RdfSets {
  std::vector<char> a, b;  // by id: whether it belongs
};

class RdfMeter {
 public:
  // `cutoff` (m): where the last of `bins` ends. InputError where a period is below two cutoffs.
  RdfMeter(const Periodic& periodic, double cutoff, size_t bins, RdfSets sets = {}, int threads = 0);

  // The box of the frames from now on: of the same axes. InputError as of the constructor.
  void set_box(const Periodic& periodic);
  // Frames of the same particles.
  void add(const std::vector<Vec3>& x);

  // With n_A, n_B particles in `volume` (m^3), n_AB of them in both, and k frames, a bin of P pairs between r
  // and r + w has
  //   g = P / (k (n_A n_B - n_AB) 4/3 pi ((r + w)^3 - r^3) / volume),
  // so that an ideal gas of any number of particles has 1. This is LAMMPS's `compute rdf`.
  Rdf result(double volume) const;

 private:
  Periodic periodic_;
  double cutoff_;
  RdfSets sets_;
  int threads_;
  size_t frames_ = 0, particles_ = 0;
  std::vector<uint64_t> pairs_;
};

// m: the first least value behind the first peak of half the highest or more, up to 1.6 times its distance:
// it parts the first shell of neighbours from the second. 0 where there is none.
double first_minimum(const Rdf& rdf);

}  // namespace cuboct
