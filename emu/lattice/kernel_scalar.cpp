// SPDX-License-Identifier: MIT
// The kernels in plain integers: the contract's own functions.
#include <algorithm>
#include <bit>
#include <cstdlib>

#include "emu/lattice/kernel.h"
#include "model/base/fixed_math.h"

namespace cuboct::emu {
namespace {

Int3 whole(const std::array<PaddedArray<double>, 3>& a, uint32_t p) {
  return {static_cast<int64_t>(a[0][p]), static_cast<int64_t>(a[1][p]), static_cast<int64_t>(a[2][p])};
}

// Sums beside kMagic as whole numbers. Between 2^52 and 2^53 doubles are spaced by 1, so their bits count
// like integers: where the vector kernels fit these are their sums, and 64 bits hold those of any rule.
int64_t taken(double sum) { return std::bit_cast<int64_t>(sum) - std::bit_cast<int64_t>(kMagic); }
void add(double& sum, int64_t value) { sum = std::bit_cast<double>(std::bit_cast<int64_t>(sum) + value); }

PairResult pair(const KernelRule& rule, const Particles& particles, uint32_t i, uint32_t j, uint8_t shift) {
  const Int3 x_i = whole(particles.x, i);
  Int3 x_j = whole(particles.x, j);
  for (int a = 0; a < 3; ++a) {
    x_j[a] += static_cast<int64_t>(particles.shift[shift][a]);
    // An entry that was not mended may keep a pair that flew apart: too far for the square of its distance.
    if (static_cast<double>(std::abs(x_j[a] - x_i[a])) > 2 * rule.cell) return {};
  }
  return pair_kick(*rule.rule, x_i, whole(particles.v, i), particles.type[i], x_j, whole(particles.v, j),
                   particles.type[j]);
}

bool near(const Particles& particles, double reach2, uint32_t base, const Entry& entry) {
  for (uint32_t l = 0; l < kGroup; ++l) {
    if ((entry.lanes >> l & 1) == 0) continue;
    double r2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double d =
          particles.x[a][entry.first + l] - particles.x[a][base + l] + particles.shift[entry.shift][a];
      r2 += d * d;
    }
    if (r2 <= reach2) return true;
  }
  return false;
}

void prune(const Particles& particles, double reach, const uint8_t* only, Block& block) {
  const auto sort = [&](PairList& list, uint32_t k, uint32_t g) {
    if (only != nullptr && !any_flag(only, particles, g)) return;
    PairList::Group& group = list.groups[k];
    Entry* const begin = list.entries.data() + group.begin;
    group.near = static_cast<uint32_t>(
        std::partition(begin, begin + group.count,
                       [&](const Entry& e) { return near(particles, reach * reach, g * kGroup, e); }) -
        begin);
  };
  for (uint32_t k = 0; k < block.groups(); ++k) sort(block.inside, k, block.first_group() + k);
  for (Edge* edge : {&block.beside, &block.ghosts})
    for (uint32_t k = 0; k < edge->group.size(); ++k)
      sort(edge->pairs, k, block.first_group() + edge->group[k]);
}

void across(const KernelRule& rule, const Particles& particles, const Active& active, Edge& edge,
            Block& block) {
  for (size_t k = 0; k < edge.group.size(); ++k) {
    const uint32_t g = block.first_group() + edge.group[k];
    if (active.near != nullptr && !any_flag(active.near, particles, g)) continue;
    double* sum = &edge.sum[k * 3 * kGroup];
    std::fill(sum, sum + 3 * kGroup, kMagic);
    const PairList::Group& group = edge.pairs.groups[k];
    for (uint32_t e = group.begin; e < group.begin + group.near; ++e) {
      const Entry& entry = edge.pairs.entries[e];
      for (uint32_t l = 0; l < kGroup; ++l) {
        if ((entry.lanes >> l & 1) == 0) continue;
        const PairResult result = pair(rule, particles, g * kGroup + l, entry.first + l, entry.shift);
        if (result.fault != Fault::none)
          block.pair_faults.push_back({result.fault, g * kGroup + l, result.number});
        for (int a = 0; a < 3; ++a) add(sum[a * kGroup + l], result.kick[a]);
      }
    }
  }
}

void inside(const KernelRule& rule, Particles& particles, const Active& active, Block& block) {
  EdgeSums beside_sums(block.beside), ghost_sums(block.ghosts);
  for (uint32_t k = 0; k < block.groups(); ++k) {
    const uint32_t g = block.first_group() + k;
    const double* beside = beside_sums.next(k);
    const double* ghosts = ghost_sums.next(k);
    const bool work = active.near == nullptr || any_flag(active.near, particles, g);
    const uint32_t slot = (k * kGroup) & block.ring_mask;
    std::array<Int3, kGroup> sums{};
    const PairList::Group& group = block.inside.groups[k];
    if (work)
      for (uint32_t e = group.begin; e < group.begin + group.near; ++e) {
        const Entry& entry = block.inside.entries[e];
        for (uint32_t l = 0; l < kGroup; ++l) {
          if ((entry.lanes >> l & 1) == 0) continue;
          const uint32_t i = g * kGroup + l, j = entry.first + l;
          const PairResult result = pair(rule, particles, i, j, entry.shift);
          if (result.fault != Fault::none) report_pair(rule, particles, i, j, entry.shift, true, block);
          const uint32_t to = ((entry.first - block.begin) & block.ring_mask) + l;
          for (int a = 0; a < 3; ++a) {
            sums[l][a] += result.kick[a];
            add(block.ring[a][to], -result.kick[a]);
          }
        }
      }
    for (uint32_t l = 0; l < kGroup; ++l) {
      for (int a = 0; a < 3; ++a) {
        double& ahead = block.ring[a][slot + l];
        sums[l][a] += taken(ahead);
        ahead = kMagic;
        if (slot == 0) {
          double& overhang = block.ring[a][block.ring_mask + 1 + l];
          sums[l][a] += taken(overhang);
          overhang = kMagic;
        }
        if (beside != nullptr) sums[l][a] += taken(beside[a * kGroup + l]);
        if (ghosts != nullptr) sums[l][a] += taken(ghosts[a * kGroup + l]);
      }
      const uint32_t p = g * kGroup + l;
      if (!work || p >= block.end || (active.awake != nullptr && active.awake[particles.cell[p]] == 0))
        continue;
      if (active.sums != nullptr)
        active.sums[p] = sums[l];
      else
        update_one(rule, particles, p, sums[l], active, block);
    }
  }
}

void update(const KernelRule& rule, Particles& particles, const Active& active, const Int3* sums,
            Block& block) {
  for (uint32_t p = block.begin; p < block.end; ++p) {
    if (active.near != nullptr && !any_flag(active.near, particles, p / kGroup)) continue;
    if (active.awake != nullptr && active.awake[particles.cell[p]] == 0) continue;
    update_one(rule, particles, p, sums[p], active, block);
  }
}

}  // namespace

void report_pair(const KernelRule& rule, const Particles& particles, uint32_t i, uint32_t j, uint8_t shift,
                 bool both, Block& block) {
  const PairResult on_i = pair(rule, particles, i, j, shift);
  if (on_i.fault != Fault::none) block.pair_faults.push_back({on_i.fault, i, on_i.number});
  if (!both) return;
  const PairResult on_j = pair(rule, particles, j, i, static_cast<uint8_t>(2 * kNoShift - shift));
  if (on_j.fault != Fault::none) block.pair_faults.push_back({on_j.fault, j, on_j.number});
}

void update_one(const KernelRule& rule, Particles& particles, uint32_t p, const Int3& sum,
                const Active& active, Block& block) {
  const int G = rule.rule->widths.guard, frac = rule.rule->widths.velocity_frac();
  const Int3 x = exact_position(particles, p, G), v = whole(particles.v, p);
  const bool pd = particles.u[0].size() > 0;
  const Int3 u = pd ? whole(particles.u, p) : Int3{};
  const FinishResult done = finish(*rule.rule, sum, x, v, u, particles.type[p]);
  if (done.fault != Fault::none) block.update_faults.push_back({done.fault, p, done.number});
  Crossing crossing{p, {}};
  bool changed = false;
  double speed2 = 0;
  for (int a = 0; a < 3; ++a) {
    crossing.away[a] = static_cast<int8_t>((done.x[a] >> frac) - (x[a] >> frac));
    changed |= done.x[a] != x[a] || done.v[a] != v[a] || done.u[a] != u[a];
    particles.x[a][p] = static_cast<double>(done.x[a] >> G);
    particles.residue[a][p] = static_cast<int32_t>(done.x[a] & ((int64_t{1} << G) - 1));
    particles.v[a][p] = static_cast<double>(done.v[a]);
    if (pd) particles.u[a][p] = static_cast<double>(done.u[a]);
    speed2 += static_cast<double>(done.v[a]) * static_cast<double>(done.v[a]);
  }
  block.fastest2 = std::max(block.fastest2, speed2);
  if (changed && active.changed != nullptr) active.mark(particles.cell[p]);
  if (crossing.away != std::array<int8_t, 3>{}) block.crossings.push_back(crossing);
}

Kernels scalar_kernels() { return {"portable", prune, across, inside, update}; }

}  // namespace cuboct::emu
