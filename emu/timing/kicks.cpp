// SPDX-License-Identifier: MIT
#include "emu/timing/kicks.h"

#include <algorithm>

#include "model/base/fixed_math.h"
#include "model/base/parallel.h"

namespace cuboct::emu {
namespace {

// Below it a step is done before threads have begun.
constexpr size_t kParticlesPerThread = 2000;

// As PairResult::inside (model/contract/fixed_step.h) has it.
bool inside(const FixedRule& rule, const Int3& x_i, int type_i, const Int3& x_j, int type_j) {
  uint64_t r2 = 0;
  for (size_t a = 0; a < 3; ++a) {
    const int64_t d = round_odd(x_j[a] - x_i[a], rule.difference_shift);
    r2 += static_cast<uint64_t>(d * d);
  }
  if (r2 >= rule.cutoff2) return false;
  const bool touches =
      rule.scaled && rule.scale[static_cast<size_t>(type_i)][static_cast<size_t>(type_j)] < 0;
  return !touches || r2 < rule.contact2;
}

}  // namespace

KickCounter::KickCounter(const Plan& plan, int threads)
    : plan_(plan),
      threads_(threads > 0 ? threads : usable_cores()),
      first_(plan.lattice.size() + 1),
      kicks_(plan.lattice.size()) {}

uint64_t KickCounter::kicks(uint32_t cell) const {
  if (first_[cell] == first_[cell + 1]) return 0;
  uint64_t count = 0;
  for (const Lattice::Near& near : plan_.lattice.neighbourhood(cell))
    for (uint32_t j = first_[near.cell]; j < first_[near.cell + 1]; ++j) {
      Body other = bodies_[j];
      for (int a = 0; a < 3; ++a)
        other.x[static_cast<size_t>(a)] += int64_t{near.offset[a]} << plan_.rule.widths.position_frac;
      for (uint32_t i = first_[cell]; i < first_[cell + 1]; ++i)
        count += i != j && inside(plan_.rule, bodies_[i].x, bodies_[i].type, other.x, other.type);
    }
  return count;
}

void KickCounter::add(std::span<const Particle> particles, std::span<MachineEvents> nodes) {
  std::fill(first_.begin(), first_.end(), 0);
  for (const Particle& p : particles) ++first_[p.cell + 1];
  for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  bodies_.resize(particles.size());
  for (const Particle& p : particles) bodies_[first_[p.cell]++] = {visible(plan_.rule, p.x), p.type};
  std::copy_backward(first_.begin(), first_.end() - 1, first_.end());
  first_[0] = 0;
  const auto range = [&](size_t from, size_t to) {
    for (size_t c = from; c < to; ++c) kicks_[c] = kicks(static_cast<uint32_t>(c));
  };
  const auto most = static_cast<int>(particles.size() / kParticlesPerThread) + 1;
  for_each_range(kicks_.size(), 1, range, std::min(threads_, most));
  for (uint32_t c = 0; c < plan_.lattice.size(); ++c) nodes[plan_.node_of(c)].kicks += kicks_[c];
}

}  // namespace cuboct::emu
