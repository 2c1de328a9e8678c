// SPDX-License-Identifier: MIT
#include "model/analysis/near_pairs.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "model/base/parallel.h"
#include "model/contract/neighbours.h"
#include "model/real/near_walk.h"

namespace cuboct {
namespace {

// A list costs as much as some kListing states with it, and its pairs grow as its volume. With u cutoffs of
// motion between two states a skin of s cutoffs serves s/(2 u) of them: (1 + s)^3 + kListing 2 u/s is least
// near s = sqrt(2 kListing u/3). Where no skin serves a second state, the thinnest costs least.
constexpr double kListing = 20, kLeastSkin = 0.02, kMostSkin = 0.3;
constexpr double kFirstSkin = 0.1;  // of a run of which nothing is known

constexpr size_t kPairedPerThread = 2000;  // particles

}  // namespace

NearPairs::NearPairs(const FixedRule& rule, const Lattice& lattice, int threads)
    : lattice_(lattice),
      frac_(rule.widths.velocity_frac()),
      threads_(threads),
      unit_(std::ldexp(rule.cell_edge, -rule.widths.velocity_frac())),
      shape_(rule.shape) {
  // Forces see rounded differences of places that are cut off.
  const int D = rule.widths.difference_frac;
  cutoff_ = std::ldexp(std::sqrt(static_cast<double>(rule.cutoff2)) + 3, -D);
  for (size_t a = 0; a < 3; ++a) period_[a] = int64_t{lattice.period()[a]} << frac_;
}

// The farthest that a particle is from where the list found it.
double NearPairs::moved() const {
  double most = 0;
  for (size_t i = 0; i < x_.size(); ++i) {
    const Int3 d = between(at_[i], x_[i]);
    double r2 = 0;
    for (size_t a = 0; a < 3; ++a) r2 += std::pow(static_cast<double>(d[a]) * shape_[a], 2);
    most = std::max(most, r2);
  }
  return std::ldexp(std::sqrt(most), -frac_) * (1 + 1e-9);
}

void NearPairs::take(const State& state) {
  x_.resize(state.particles.size());
  for (size_t i = 0; i < x_.size(); ++i) {
    const Particle& p = state.particles[i];
    const Cell& cell = lattice_.cell(p.cell);
    for (size_t a = 0; a < 3; ++a)
      x_[i][a] = static_cast<int64_t>((static_cast<uint64_t>(int64_t{cell[a]}) << frac_) +
                                      static_cast<uint64_t>(p.x[a]));
  }
  ++states_;
  double each = -1;  // cutoffs between two states
  if (at_.size() == x_.size()) {
    const double far = moved();
    if (2 * far <= skin_) return;
    each = far / static_cast<double>(states_) / cutoff_;
  }
  if (each < 0)
    skin_ = kFirstSkin * cutoff_;
  else if (2 * each > kMostSkin)
    skin_ = kLeastSkin * cutoff_;
  else
    skin_ = cutoff_ * std::clamp(std::sqrt(2 * kListing * each / 3), kLeastSkin, kMostSkin);
  list();
}

void NearPairs::distances(size_t block, double cutoff, PairDistances& inside,
                          std::vector<PairAcross>& across) const {
  near_distances({x_.data(), period_, first_of(block), first_of(block + 1), first_.data(), other_.data()},
                 unit_, shape_, cutoff, inside, across);
}

void NearPairs::list() {
  at_ = x_;
  states_ = 0;
  ++lists_made_;
  Periodic periodic;
  for (size_t a = 0; a < 3; ++a) periodic.extent[a] = lattice_.period()[a] * shape_[a];
  std::vector<Vec3> place(x_.size());
  for (size_t i = 0; i < x_.size(); ++i)
    for (size_t a = 0; a < 3; ++a)
      place[i][a] = std::ldexp(static_cast<double>(x_[i][a]), -frac_) * shape_[a];
  CellList cells(cutoff_, periodic, skin_);
  cells.build(place);
  const std::span<const uint32_t> order = cells.order();
  const NearWalk walk(cells, place, periodic);
  const double range = (cutoff_ + skin_) * (1 + 1e-9);
  // Stretches of particles in the order of cells, each with the particles near it that have a larger id.
  const int threads = threads_ > 0 ? threads_ : usable_cores();
  const size_t parts = std::clamp<size_t>(x_.size() / kPairedPerThread, 1, static_cast<size_t>(threads));
  std::vector<std::vector<uint32_t>> found(parts);
  std::vector<uint32_t> count(x_.size());
  const auto begin_of = [&](size_t part) { return order.size() * part / parts; };
  for_each_part(parts, threads, [&](size_t p, int) {
    walk(range, begin_of(p), begin_of(p + 1), [&](size_t slot, std::span<const uint64_t> near) {
      const uint32_t i = order[slot];
      for (const uint64_t one : near)
        if (const auto j = static_cast<uint32_t>(one >> 32); j > i) found[p].push_back(j), ++count[i];
    });
  });
  first_.assign(x_.size() + 1, 0);
  for (size_t i = 0; i < x_.size(); ++i) first_[i + 1] = first_[i] + count[i];
  other_.resize(first_.back());
  for_each_part(parts, threads, [&](size_t p, int) {
    auto from = found[p].begin();
    for (size_t slot = begin_of(p); slot < begin_of(p + 1); ++slot) {
      const uint32_t i = order[slot];
      std::copy_n(from, count[i], other_.begin() + static_cast<ptrdiff_t>(first_[i]));
      from += count[i];
    }
  });
}

}  // namespace cuboct
