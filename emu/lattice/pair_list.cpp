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
  template <typename Entries>
  void take(Entries& out) {
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
                const std::vector<uint32_t>& place, const Particles& particles, double reach,
                const std::vector<uint8_t>* only, Block& block) {
  Search search(lattice, rows, snapshot, reach);
  Merger inside, across;
  PairList new_inside{{0}, {}}, new_across{{0}, {}};
  std::vector<uint32_t> edge_group;
  if (only == nullptr) {  // the old memory serves again
    new_inside.entries.swap(block.far_inside.entries);
    new_across.entries.swap(block.far_across.entries);
    new_inside.entries.clear();
    new_across.entries.clear();
    block.plain.assign(block.groups(), 1);
  }
  // More than a crystal needs; what is not used is never touched.
  new_inside.entries.reserve(size_t{block.groups()} * 32);
  new_inside.first.reserve(block.groups() + 1);
  size_t old_edge = 0;
  uint32_t window = kGroup;
  const auto keep = [](const PairList& from, size_t k, PairList& to) {
    to.entries.insert(to.entries.end(), from.entries.begin() + from.first[k], from.entries.begin() + from.first[k + 1]);
  };
  for (uint32_t k = 0; k < block.groups(); ++k) {
    const uint32_t base = (block.first_group() + k) * kGroup;
    const bool had_edge = only != nullptr && old_edge < block.edge_group.size() && block.edge_group[old_edge] == k;
    if (only != nullptr && (*only)[block.first_group() + k] == 0) {
      keep(block.far_inside, k, new_inside);
      if (had_edge) keep(block.far_across, old_edge, new_across);
    } else {
      const uint32_t end = std::min(base + kGroup, block.end);
      for (uint32_t i = base; i < end; ++i) {
        const uint8_t type = particles.type[i];
        // A group is updated in vectors if its types are free and fall alike.
        if (rule.plain[type] == 0 ||
            rule.rule->types[type].gravity != rule.rule->types[particles.type[base]].gravity)
          block.plain[k] = 0;
        for (const auto& [j, shift] : search.around(particles.node[i], place[i])) {
          const auto first = static_cast<int32_t>(j) - static_cast<int32_t>(i - base);
          if (j < block.begin || j >= block.end)
            across.add(first, shift, i - base);
          else if (j > i)
            inside.add(first, shift, i - base);
        }
      }
      inside.take(new_inside.entries);
      across.take(new_across.entries);
    }
    old_edge += had_edge;
    const auto last = static_cast<uint32_t>(new_inside.entries.size());
    if (last > new_inside.first.back())
      window = std::max(window, static_cast<uint32_t>(new_inside.entries.back().first) + kGroup - base);
    new_inside.first.push_back(last);
    if (new_across.entries.size() > new_across.first.back()) {
      edge_group.push_back(k);
      new_across.first.push_back(static_cast<uint32_t>(new_across.entries.size()));
    }
  }
  block.far_inside = std::move(new_inside);
  block.far_across = std::move(new_across);
  block.edge_group = std::move(edge_group);
  block.across_sum = PaddedArray<double>(block.edge_group.size() * 3 * kGroup, kMagic);
  // The group at hand and those up to the farthest partner never meet in the ring.
  const uint32_t size = std::bit_ceil(window + kGroup);
  block.ring_mask = size - 1;
  for (auto& ring : block.ring) ring = PaddedArray<double>(size, kMagic);
}

}  // namespace cuboct::emu
