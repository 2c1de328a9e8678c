// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/partner_list.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace cuboct::emu {

void PartnerList::build(const Block& block, const Particles& particles, int position_frac, bool once,
                        Search search) {
  rows_.clear();
  partners_.clear();
  for (uint32_t i = block.begin; i < block.end; ++i) {
    const auto begin = static_cast<uint32_t>(partners_.size());
    const std::array at{coarse(particles.x[0][i], position_frac), coarse(particles.x[1][i], position_frac),
                        coarse(particles.x[2][i], position_frac)};
    for (const auto& [j, shift] : search.around(particles.cell[i], at))
      if (j > i || (j < i && !(once && j >= block.begin))) partners_.push_back(Partner::of(j, shift));
    if (partners_.size() > std::numeric_limits<uint32_t>::max())
      throw std::length_error("a list of more than 2^32 - 1 partners: use more threads");
    // Ascending, so that neighbouring lanes read neighbouring memory.
    std::sort(partners_.begin() + begin, partners_.end(), [](uint32_t a, uint32_t b) {
      return std::pair(Partner::index(a), a) < std::pair(Partner::index(b), b);
    });
    const auto end = static_cast<uint32_t>(partners_.size());
    rows_.push_back({begin, end, end, 0});
  }
}

void PartnerList::build(const Block& block, const Particles& particles, const Index& index,
                        const graph::BondRows& rows) {
  rows_.clear();
  partners_.clear();
  for (uint32_t i = block.begin; i < block.end; ++i) {
    const uint32_t id = particles.id_of(i);
    const auto begin = static_cast<uint32_t>(partners_.size());
    for (uint64_t b = rows.first[id]; b < rows.first[id + 1]; ++b)
      partners_.push_back(Partner::of(index(rows.other[b]), kNoShift));
    const auto end = static_cast<uint32_t>(partners_.size());
    rows_.push_back({begin, end, end, rows.first[id]});
  }
}

void PartnerList::prune(const Block& block, const Particles& particles, double reach) {
  for (uint32_t i = block.begin; i < block.end; ++i) {
    Row& row = rows_[i - block.begin];
    const auto is_near = [&](uint32_t partner) {
      const uint32_t j = Partner::index(partner);
      const auto& shift = particles.shift[Partner::shift(partner)];
      double r2 = 0;
      for (size_t a = 0; a < 3; ++a) {
        const double d = particles.x[a][j] - particles.x[a][i] + shift[a];
        r2 += d * d;
      }
      return r2 <= reach * reach;
    };
    const auto begin = partners_.begin() + row.begin;
    row.near = row.begin +
               static_cast<uint32_t>(std::partition(begin, partners_.begin() + row.end, is_near) - begin);
  }
}

}  // namespace cuboct::emu
