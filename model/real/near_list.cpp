// SPDX-License-Identifier: MIT
#include "model/real/near_list.h"

#include <algorithm>
#include <array>

#include "model/base/parallel.h"
#include "model/real/near_walk.h"

namespace cuboct {
namespace {

// Of the cutoff.
constexpr std::array<double, 13> kSkins{0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07,
                                        0.08, 0.1,  0.14, 0.2,  0.27, 0.35};

// What a particle costs in a new list, in times of one listed pair in one step (measured: 400 ns and 2 ns, 3
// to 5 ns).
constexpr double kListing = 150, kCandidate = 0.4;
constexpr size_t kSample = 256;  // particles whose neighbours are counted

}  // namespace

NearList::NearList(double cutoff, const Periodic& periodic, double margin, size_t lanes, int threads)
    : cutoff_(cutoff),
      margin_(margin),
      periodic_(periodic),
      nearest_(cutoff, periodic),
      lanes_(lanes),
      threads_(threads) {}

void NearList::set_box(const Periodic& periodic, double margin) {
  periodic_ = periodic;
  margin_ = margin;
  nearest_ = CellList(cutoff_, periodic);
}

// Each skin costs its longer lists at each step, and a new list whenever the fastest particle has crossed
// half of it.
void NearList::plan(std::span<const Vec3> x, double speed) {
  CellList cells(cutoff_, periodic_, cutoff_ * kSkins.back());
  cells.build(x);
  std::array<double, kSkins.size()> listed{};
  const std::span<const uint32_t> order = cells.order();
  const size_t stride = std::max<size_t>(1, order.size() / kSample);
  size_t sampled = 0;
  for (size_t s = 0; s < order.size(); s += stride, ++sampled) {
    const Vec3& home = x[order[s]];
    cells.for_each_near(cells.cell_at(home), [&](int64_t cell) {
      for (uint32_t b = cells.begin_of(cell); b < cells.end_of(cell); ++b) {
        const double r = nearest_.difference(home, x[order[b]]).norm();
        for (size_t k = 0; k < kSkins.size(); ++k) listed[k] += r < cutoff_ * (1 + kSkins[k]) ? 1 : 0;
      }
    });
  }
  double least = 0;
  for (size_t k = 0; k < kSkins.size(); ++k) {
    const double skin = cutoff_ * kSkins[k];
    const double steps = speed > 0 ? std::clamp(skin / (2 * speed), 1.0, 1e6) : 1e6;
    // 27 cells of the list's range hold 27/(4 pi/3) times what its sphere holds.
    const double pairs = listed[k] / static_cast<double>(std::max<size_t>(1, sampled));
    const double cost = pairs + (kListing + kCandidate * 6.4 * pairs) / steps;
    if (k == 0 || cost < least) {
      skin_ = skin;
      least = cost;
    }
  }
}

void NearList::build(std::span<const Vec3> x) {
  CellList cells(cutoff_, periodic_, skin_ + margin_);
  cells.build(x);
  order_.assign(cells.order().begin(), cells.order().end());
  groups_ = (order_.size() + lanes_ - 1) / lanes_;
  const NearWalk walk(cells, {x.begin(), x.end()}, periodic_);
  const size_t count = static_cast<size_t>(threads_);
  parts_.resize(count);
  for_each_part(count, threads_, [&](size_t p, int) {
    parts_[p].first_group = groups_ * p / count;
    fill(walk, parts_[p], groups_ * (p + 1) / count);
  });
}

void NearList::fill(const NearWalk& walk, PairRows& part, size_t end_group) const {
  const double range = cutoff_ + skin_ + margin_;
  part.begin.assign(1, 0);
  part.entry.clear();
  std::vector<std::vector<uint32_t>> lists(lanes_);
  const auto end_of_group = [&](size_t first_slot) {
    size_t longest = 0;
    for (const auto& list : lists) longest = std::max(longest, list.size());
    for (size_t k = 0; k < longest; ++k)
      for (size_t lane = 0; lane < lanes_; ++lane) {
        const uint32_t own = static_cast<uint32_t>(first_slot + lane);
        part.entry.push_back(4 * (k < lists[lane].size() ? lists[lane][k] : own));
      }
    part.begin.push_back(part.begin.back() + longest);
    for (auto& list : lists) list.clear();
  };
  const size_t begin = part.first_group * lanes_, end = std::min(order_.size(), end_group * lanes_);
  walk(range, begin, end, [&](size_t slot, std::span<const uint64_t> near) {
    const size_t lane = slot % lanes_;
    for (const uint64_t one : near)
      if (const auto other = static_cast<uint32_t>(one); other != slot) lists[lane].push_back(other);
    if (lane + 1 == lanes_ || slot + 1 == end) end_of_group(slot - lane);
  });
}

}  // namespace cuboct
