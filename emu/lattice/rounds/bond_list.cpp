// SPDX-License-Identifier: MIT
#include "emu/lattice/rounds/bond_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <tuple>

#include "model/graph/program.h"

#include "model/contract/program_run.h"

namespace cuboct::emu {
namespace {

struct Bond {
  Ends ends;
  int32_t first;
  uint8_t shift;
  uint32_t lane;
  uint64_t bond;
  auto place() const { return std::tuple(ends, first, shift); }
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

bool BondSpace::meets(const std::array<double, 3>& own, std::array<double, 3>& apart) const {
  for (size_t a = 0; a < 3; ++a) {
    const auto cells = [&] { return std::floor((own[a] + apart[a]) / cell) - std::floor(own[a] / cell); };
    if (period[a] > 0) {
      apart[a] -= std::round(apart[a] / period[a]) * period[a];
      // In a ring of three the image in a neighbouring cell may be farther away than another.
      if (std::abs(cells()) > 1) apart[a] -= std::copysign(period[a], apart[a]);
    }
    if (std::abs(cells()) > 1) return false;
  }
  return true;
}

// Rare: golden's own.
bool BondList::is_broken(const graph::FixedProgram& program, const BondSpace& space, size_t slot) const {
  std::vector<int64_t> whole;
  for (const auto& values : numbers) whole.push_back(static_cast<int64_t>(values[slot]));
  const auto constants = space.rows->constants.data() + kind[slot] * program.bond_constants.size();
  return cuboct::is_broken(program, {.bond = whole.data(), .bond_constants = constants});
}

void BondList::build(const Block& block, const Particles& particles, const Index& index,
                     const BondSpace& space, bool once, int number_count) {
  const graph::BondRows& rows = *space.rows;
  *this = {};
  std::vector<Bond> bonds;
  for (uint32_t base = block.begin; base < block.end; base += kGroup) {
    bonds.clear();
    for (uint32_t i = base; i < std::min(base + kGroup, block.end); ++i) {
      const uint32_t id = particles.id_of(i);
      for (uint64_t b = rows.first[id]; b < rows.first[id + 1]; ++b) {
        const uint32_t j = index(rows.other[b]);
        if (j == kNoParticle) {
          far.push_back(b);
          continue;
        }
        const bool inside = once && j >= block.begin && j < block.end;
        if (inside && j < i) continue;
        bonds.push_back({inside ? Ends::both : Ends::own,
                         static_cast<int32_t>(j) - static_cast<int32_t>(i - base),
                         image(particles, i, j, space.period), i - base, b});
      }
    }
    std::ranges::sort(bonds, {}, [](const Bond& b) { return std::tuple_cat(b.place(), std::tuple(b.lane)); });
    both.push_back({static_cast<uint32_t>(entries.size()), 0, 0});
    const Bond* last = nullptr;
    for (const Bond& one : bonds) {
      if (one.ends == Ends::own && (last == nullptr || last->ends != Ends::own)) {
        own.push_back({static_cast<uint32_t>(entries.size()), 0, 0});
        own_group.push_back((base - block.begin) / kGroup);
      }
      EntryGroup& group = one.ends == Ends::both ? both.back() : own.back();
      if (last == nullptr || last->place() != one.place()) {
        if (group.count++ == 0) group.begin = static_cast<uint32_t>(entries.size());
        group.near = group.count;
        entries.push_back({one.first, 0, one.shift});
        if (one.ends == Ends::both)
          window = std::max(window, static_cast<uint32_t>(one.first) + kGroup - base);
        for (auto* of : {&bond, &twin}) of->insert(of->end(), kGroup, kNoBond);
      }
      last = &one;
      entries.back().lanes = static_cast<uint8_t>(entries.back().lanes | 1u << one.lane);
      const size_t at = slot(entries.size() - 1, one.lane);
      bond[at] = one.bond;
      if (one.ends == Ends::both) twin[at] = rows.twin(particles.id_of(base + one.lane), one.bond);
    }
    if (entries.size() > std::numeric_limits<uint32_t>::max())
      throw std::length_error("a list of more than 2^32 - 1 entries: use more threads");
  }
  add_kinds(rows);
  for (int k = 0; k < number_count; ++k) numbers.emplace_back(bond.size());
}

// Lanes without a bond have the kind of one that is there: vectors look whether all are alike.
void BondList::add_kinds(const graph::BondRows& rows) {
  kind = PaddedArray<uint32_t>(bond.size());
  for (size_t begin = 0; begin < bond.size(); begin += kGroup) {
    const auto lanes = std::span(bond).subspan(begin, kGroup);
    const uint32_t some = rows.kind[*std::ranges::find_if(lanes, [](uint64_t b) { return b != kNoBond; })];
    for (size_t l = 0; l < kGroup; ++l) kind[begin + l] = lanes[l] != kNoBond ? rows.kind[lanes[l]] : some;
  }
}

}  // namespace cuboct::emu
