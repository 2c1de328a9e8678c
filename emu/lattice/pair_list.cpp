// SPDX-License-Identifier: MIT
#include "emu/lattice/pair_list.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace cuboct::emu {
namespace {

// Collects a group's pairs into entries: a small open hash table by (first, shift), emptied by counting laps.
class Merger {
 public:
  Merger() : table_(size_) {}
  void add(int32_t first, uint8_t shift, uint32_t lane) {
    uint32_t at = (static_cast<uint32_t>(first) * 2654435761u + shift * 40503u) >> (32 - bits_);
    for (;; at = (at + 1) & (size_ - 1)) {
      Place& place = table_[at];
      if (place.lap != lap_) {
        place = {lap_, static_cast<uint32_t>(entries_.size())};
        entries_.push_back({first, static_cast<uint8_t>(1u << lane), shift});
        if (entries_.size() > size_ / 2) grow();
        return;
      }
      Entry& entry = entries_[place.entry];
      if (entry.first == first && entry.shift == shift) {
        entry.lanes = static_cast<uint8_t>(entry.lanes | 1u << lane);
        return;
      }
    }
  }
  // In order of `first`; appended to `out`.
  void take(std::vector<Entry>& out) {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return std::tie(a.first, a.shift) < std::tie(b.first, b.shift);
    });
    out.insert(out.end(), entries_.begin(), entries_.end());
    entries_.clear();
    ++lap_;
  }

 private:
  struct Place {
    uint32_t lap = 0, entry = 0;
  };
  void grow() {
    bits_ += 1;
    size_ *= 2;
    table_.assign(size_, {});
    for (uint32_t e = 0; e < entries_.size(); ++e) {
      uint32_t at = (static_cast<uint32_t>(entries_[e].first) * 2654435761u + entries_[e].shift * 40503u) >> (32 - bits_);
      while (table_[at].lap == lap_) at = (at + 1) & (size_ - 1);
      table_[at] = {lap_, e};
    }
  }
  uint32_t bits_ = 9, size_ = 512;
  uint32_t lap_ = 1;
  std::vector<Place> table_;
  std::vector<Entry> entries_;
};

}  // namespace

void build_list(const KernelRule& rule, const Lattice& lattice, const Rows& rows, const Snapshot& snapshot,
                const Particles& particles, double reach, Block& block) {
  const int P = rule.rule->widths.position_frac;
  Search search(lattice, rows, snapshot, reach);
  Merger inside, across;
  for (PairList* list : {&block.far_inside, &block.far_across}) {
    list->first.assign(1, 0);
    list->entries.clear();
  }
  block.edge_group.clear();
  block.plain.assign(block.groups(), 1);
  uint32_t window = kGroup;
  for (uint32_t k = 0; k < block.groups(); ++k) {
    const uint32_t base = (block.first_group() + k) * kGroup;
    const uint32_t end = std::min(base + kGroup, block.end);
    for (uint32_t i = base; i < end; ++i) {
      const uint8_t type = particles.type[i];
      // A group is updated in vectors if its types are free and fall alike.
      if (rule.plain[type] == 0 || rule.rule->types[type].gravity != rule.rule->types[particles.type[base]].gravity)
        block.plain[k] = 0;
      for (const auto& [j, shift] : search.around(particles.node[i], coarse(particles.x[0][i], P),
                                                  coarse(particles.x[1][i], P), coarse(particles.x[2][i], P))) {
        const auto first = static_cast<int32_t>(j) - static_cast<int32_t>(i - base);
        if (j < block.begin || j >= block.end)
          across.add(first, shift, i - base);
        else if (j > i)
          inside.add(first, shift, i - base);
      }
    }
    inside.take(block.far_inside.entries);
    const auto last = static_cast<uint32_t>(block.far_inside.entries.size());
    if (last > block.far_inside.first.back())
      window = std::max(window, static_cast<uint32_t>(block.far_inside.entries.back().first) + kGroup - base);
    block.far_inside.first.push_back(last);
    across.take(block.far_across.entries);
    if (block.far_across.entries.size() > block.far_across.first.back()) {
      block.edge_group.push_back(k);
      block.far_across.first.push_back(static_cast<uint32_t>(block.far_across.entries.size()));
    }
  }
  block.across_sum = PaddedArray<double>(block.edge_group.size() * 3 * kGroup, kMagic);
  // The group at hand and those up to the farthest partner never meet in the ring.
  const uint32_t size = std::bit_ceil(window + kGroup);
  block.ring_mask = size - 1;
  for (auto& ring : block.ring) ring = PaddedArray<double>(size, kMagic);
}

}  // namespace cuboct::emu
