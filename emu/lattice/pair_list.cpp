// SPDX-License-Identifier: MIT
#include "emu/lattice/pair_list.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>

namespace cuboct::emu {
namespace {

// Collects a group's pairs into entries: a small open hash table by (first, shift), emptied by counting laps.
class Merger {
 public:
  Merger() : table_(size_) {}
  void add(int32_t first, uint8_t shift, uint32_t lane) {
    for (uint32_t at = home(first, shift);; at = (at + 1) & (size_ - 1)) {
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
      return std::pair(a.first, a.shift) < std::pair(b.first, b.shift);
    });
    out.insert(out.end(), entries_.begin(), entries_.end());
    entries_.clear();
    ++lap_;
  }

 private:
  struct Place {
    uint32_t lap = 0, entry = 0;
  };
  // Multiplicative hashing (Knuth).
  uint32_t home(int32_t first, uint8_t shift) const {
    return (static_cast<uint32_t>(first) * 2654435761u + shift * 40503u) >> (32 - bits_);
  }
  void grow() {
    bits_ += 1;
    size_ *= 2;
    table_.assign(size_, {});
    for (uint32_t e = 0; e < entries_.size(); ++e) {
      uint32_t at = home(entries_[e].first, entries_[e].shift);
      while (table_[at].lap == lap_) at = (at + 1) & (size_ - 1);
      table_[at] = {lap_, e};
    }
  }
  uint32_t bits_ = 9, size_ = 512;
  uint32_t lap_ = 1;
  std::vector<Place> table_;
  std::vector<Entry> entries_;
};

// The entries of one group: `at(particle)` is where it was found.
template <typename At>
void collect(const Particles& particles, const Block& block, uint32_t base, Search& search, const At& at,
             uint32_t ghosts, Merger& inside, Merger& beside, Merger& beyond) {
  const uint32_t end = std::min(base + kGroup, block.end);
  for (uint32_t i = base; i < end; ++i)
    for (const auto& [j, shift] : search.around(particles.cell[i], at(i))) {
      const auto first = static_cast<int32_t>(j) - static_cast<int32_t>(i - base);
      if (j >= ghosts)
        beyond.add(first, shift, i - base);
      else if (j < block.begin || j >= block.end)
        beside.add(first, shift, i - base);
      else if (j > i)
        inside.add(first, shift, i - base);
    }
}

// What is not used is never touched.
constexpr size_t kUsualEntries = 32;

// The place of the next entry.
uint32_t next_place(const PairList& list) {
  if (list.entries.size() > std::numeric_limits<uint32_t>::max())
    throw std::length_error("a pair list of more than 2^32 - 1 entries: use more threads");
  return static_cast<uint32_t>(list.entries.size());
}

void close_group(const PairList& list, uint32_t begin, PairList::Group& group) {
  const auto count = static_cast<uint32_t>(list.entries.size() - begin);
  group = {begin, count, count};
}

// Where mended groups left more holes than entries, the entries move together.
void close_holes(PairList& list) {
  size_t count = 0;
  for (const PairList::Group& group : list.groups) count += group.count;
  if (list.entries.size() <= 2 * count + kUsualEntries) return;
  std::vector<Entry, Untouched<Entry>> entries;
  entries.reserve(count);
  for (PairList::Group& group : list.groups) {
    const auto begin = static_cast<uint32_t>(entries.size());
    entries.insert(entries.end(), list.entries.begin() + group.begin,
                   list.entries.begin() + group.begin + group.count);
    group.begin = begin;
  }
  list.entries = std::move(entries);
}

void close_edge(Merger& merger, uint32_t k, Edge& edge) {
  const uint32_t begin = next_place(edge.pairs);
  merger.take(edge.pairs.entries);
  if (edge.pairs.entries.size() == begin) return;
  edge.group.push_back(k);
  close_group(edge.pairs, begin, edge.pairs.groups.emplace_back());
}

// How far ahead of group k its entries reach, in particles.
uint32_t window_of(const Block& block, uint32_t k) {
  uint32_t window = kGroup;
  const PairList::Group& group = block.inside.groups[k];
  for (uint32_t e = group.begin; e < group.begin + group.count; ++e)
    window =
        std::max(window, static_cast<uint32_t>(block.inside.entries[e].first) - block.begin - k * kGroup);
  return window;
}

// Room for sums up to `window` ahead, an entry's own width, and the group at hand.
void make_ring(Block& block, uint32_t window) {
  block.window = std::max(block.window, window);
  const uint32_t size = std::bit_ceil(window + 2 * kGroup);
  if (size <= block.ring_mask + 1) return;
  block.ring_mask = size - 1;
  for (auto& ring : block.ring) ring = PaddedArray<double>(size, kMagic);
}

}  // namespace

void build_list(const KernelRule& rule, const Particles& particles, uint32_t ghosts, Search search,
                Block& block) {
  Merger inside, beside, beyond;
  block.inside.entries.clear();
  block.inside.entries.reserve(kUsualEntries * block.groups());
  block.inside.groups.resize(block.groups());
  for (Edge* edge : {&block.beside, &block.ghosts}) {
    edge->group.clear();
    edge->pairs.groups.clear();
    edge->pairs.entries.clear();
    edge->pairs.entries.reserve(kUsualEntries * block.groups());
  }
  block.plain.assign(block.groups(), 1);
  block.ring_mask = block.window = 0;
  uint32_t window = kGroup;
  // A particle's place is not where the bins have it, but it was rounded from its position just now.
  const int P = rule.rule->widths.position_frac;
  const auto at = [&](uint32_t p) {
    return std::array{coarse(particles.x[0][p], P), coarse(particles.x[1][p], P),
                      coarse(particles.x[2][p], P)};
  };
  for (uint32_t k = 0; k < block.groups(); ++k) {
    const uint32_t base = block.begin + k * kGroup;
    // A group is updated in vectors if its types are free and fall alike.
    for (uint32_t i = base; i < std::min(base + kGroup, block.end); ++i) {
      const uint8_t type = particles.type[i];
      if (rule.plain[type] == 0 ||
          rule.rule->types[type].gravity != rule.rule->types[particles.type[base]].gravity)
        block.plain[k] = 0;
    }
    collect(particles, block, base, search, at, ghosts, inside, beside, beyond);
    const uint32_t begin = next_place(block.inside);
    inside.take(block.inside.entries);
    close_group(block.inside, begin, block.inside.groups[k]);
    window = std::max(window, window_of(block, k));
    close_edge(beside, k, block.beside);
    close_edge(beyond, k, block.ghosts);
  }
  for (Edge* edge : {&block.beside, &block.ghosts})
    edge->sum = PaddedArray<double>(edge->group.size() * 3 * kGroup, kMagic);
  make_ring(block, window);
}

void mend_list(const Particles& particles, const Snapshot& snapshot, Search search,
               const std::vector<uint8_t>& only, Block& block) {
  Merger inside, beside, beyond;
  std::vector<Entry> entries;
  const auto at = [&](uint32_t p) {
    return std::array{snapshot.at[0][p], snapshot.at[1][p], snapshot.at[2][p]};
  };
  // Where they were, if they fit there; else behind all others.
  const auto put = [&entries](PairList& list, PairList::Group& group, uint32_t room) {
    const auto count = static_cast<uint32_t>(entries.size());
    if (count > room) {
      group.begin = next_place(list);
      list.entries.resize(list.entries.size() + count);
    }
    group.near = group.count = count;
    std::copy(entries.begin(), entries.end(), list.entries.begin() + group.begin);
  };
  // By group, one beyond: its place in block.beside.
  std::vector<uint32_t> edge(block.groups());
  for (uint32_t k = 0; k < block.beside.group.size(); ++k) edge[block.beside.group[k]] = k + 1;
  bool new_edges = false;
  uint32_t window = kGroup;
  for (uint32_t k = 0; k < block.groups(); ++k) {
    if (only[block.first_group() + k] == 0) continue;
    collect(particles, block, block.begin + k * kGroup, search, at, kNoParticle, inside, beside, beyond);
    entries.clear();
    inside.take(entries);
    put(block.inside, block.inside.groups[k], block.inside.groups[k].count);
    window = std::max(window, window_of(block, k));
    entries.clear();
    beside.take(entries);
    if (entries.empty() && edge[k] == 0) continue;
    if (edge[k] == 0) {
      block.beside.group.push_back(k);
      edge[k] = static_cast<uint32_t>(block.beside.group.size());
      block.beside.pairs.groups.push_back({0, 0, 0});
      new_edges = true;
    }
    PairList::Group& group = block.beside.pairs.groups[edge[k] - 1];
    put(block.beside.pairs, group, group.count);
  }
  if (new_edges) {
    // The kernels meet the edges in the order of their groups.
    std::vector<PairList::Group> groups;
    block.beside.group.clear();
    for (uint32_t k = 0; k < block.groups(); ++k)
      if (edge[k] != 0) {
        block.beside.group.push_back(k);
        groups.push_back(block.beside.pairs.groups[edge[k] - 1]);
      }
    block.beside.pairs.groups = std::move(groups);
    block.beside.sum = PaddedArray<double>(block.beside.group.size() * 3 * kGroup, kMagic);
  }
  close_holes(block.inside);
  close_holes(block.beside.pairs);
  make_ring(block, window);
}

}  // namespace cuboct::emu
