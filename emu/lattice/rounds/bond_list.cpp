// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/bond_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

namespace cuboct::emu {
namespace {

struct Bond {
  int32_t first;
  uint8_t shift;
  uint32_t lane;
  uint64_t bond;
  std::tuple<int32_t, uint8_t, uint32_t> order() const { return {first, shift, lane}; }
};

// The partner's nearest image: an index into Particles::shift.
uint8_t image(const Particles& particles, uint32_t own, uint32_t other, const std::array<double, 3>& period) {
  int shift = kNoShift;
  for (int a = 0, scale = 1; a < 3; ++a, scale *= 3)
    if (period[a] > 0)
      shift -=
          scale * static_cast<int>(std::round((particles.x[a][other] - particles.x[a][own]) / period[a]));
  return static_cast<uint8_t>(shift);
}

}  // namespace

void BondList::build(const Block& block, const Particles& particles, const Index& index,
                     const graph::BondRows& rows, const std::array<double, 3>& period, int number_count) {
  pairs.entries.clear();
  pairs.groups.clear();
  bond.clear();
  std::vector<Bond> bonds;
  for (uint32_t base = block.begin; base < block.end; base += kGroup) {
    bonds.clear();
    for (uint32_t i = base; i < std::min(base + kGroup, block.end); ++i) {
      const uint32_t id = particles.id_of(i);
      for (uint64_t b = rows.first[id]; b < rows.first[id + 1]; ++b) {
        const uint32_t j = index(rows.other[b]);
        bonds.push_back({static_cast<int32_t>(j) - static_cast<int32_t>(i - base),
                         image(particles, i, j, period), i - base, b});
      }
    }
    std::sort(bonds.begin(), bonds.end(), [](const Bond& a, const Bond& b) { return a.order() < b.order(); });
    const size_t begin = pairs.entries.size();
    for (const Bond& one : bonds) {
      if (pairs.entries.size() == begin || pairs.entries.back().first != one.first ||
          pairs.entries.back().shift != one.shift) {
        pairs.entries.push_back({one.first, 0, one.shift});
        bond.insert(bond.end(), kGroup, kNoBond);
      }
      Entry& entry = pairs.entries.back();
      entry.lanes = static_cast<uint8_t>(entry.lanes | 1u << one.lane);
      bond[slot(pairs.entries.size() - 1, one.lane)] = one.bond;
    }
    if (pairs.entries.size() > std::numeric_limits<uint32_t>::max())
      throw std::length_error("a list of more than 2^32 - 1 entries: use more threads");
    const auto count = static_cast<uint32_t>(pairs.entries.size() - begin);
    pairs.groups.push_back({static_cast<uint32_t>(begin), count, count});
  }
  kind = PaddedArray<uint32_t>(bond.size());
  for (size_t s = 0; s < bond.size(); ++s)
    if (bond[s] != kNoBond) kind[s] = rows.kind[bond[s]];
  numbers.clear();
  before.clear();
  for (int k = 0; k < number_count; ++k) numbers.emplace_back(bond.size()), before.emplace_back(bond.size());
}

}  // namespace cuboct::emu
